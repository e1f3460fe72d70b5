#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Tests tests/totals.py with logs whose totals are known: check_totals.py TOTALS.PY"""
import json
import subprocess
import sys
import tempfile
from pathlib import Path

CASES = [
    # (result, stdout) of each program, the expected last line, the expected exit code
    ([('OK', 'x\n100%: Checks: 7, Failures: 0, Errors: 0\n')], '7 passed, 0 failed, 0 skipped', 0),
    ([('OK', None), ('EXPECTEDFAIL', '')], '2 passed, 0 failed, 0 skipped', 0),
    ([('OK', '100%: Checks: 2, Failures: 0, Errors: 0\n100%: Checks: 3, Failures: 0, Errors: 0\n')],
     '5 passed, 0 failed, 0 skipped', 0),
    ([('FAIL', '60%: Checks: 5, Failures: 1, Errors: 1\n'), ('OK', '')], '4 passed, 2 failed, 0 skipped', 1),
    ([('TIMEOUT', 'begins'), ('OK', '')], '1 passed, 1 failed, 0 skipped', 1),
    ([('FAIL', '100%: Checks: 5, Failures: 0, Errors: 0\n')], '5 passed, 1 failed, 0 skipped', 1),
    ([('OK', '100%: Checks: 0, Failures: 0, Errors: 0\n')], '0 passed, 1 failed, 0 skipped', 1),
    ([('SKIP', '')], '0 passed, 0 failed, 1 skipped', 1),
    ([], '0 passed, 0 failed, 0 skipped', 1),
]


# Several logs: each a list as above, or None for a log that is missing
SEVERAL = [
    ([[('OK', '')], [('OK', '100%: Checks: 2, Failures: 0, Errors: 0\n')]], '3 passed, 0 failed, 0 skipped', 0),
    ([[('OK', '')], [('FAIL', '')]], '1 passed, 1 failed, 0 skipped', 1),
    ([[('OK', '')], []], '1 passed, 0 failed, 0 skipped', 1),
    ([[('OK', '')], None], '1 passed, 0 failed, 0 skipped', 1),
]


def write_log(folder, number, entries):
    """Writes a log as meson does, and returns its path."""
    path = Path(folder) / f'{number}.json'
    if entries is not None:
        path.write_text(''.join(json.dumps({'name': str(i), 'result': result, 'stdout': stdout}) + '\n'
                                for i, (result, stdout) in enumerate(entries)), encoding='utf-8')
    return path


def main():
    wrong = 0
    for logs, line, code in [([entries], line, code) for entries, line, code in CASES] + SEVERAL:
        with tempfile.TemporaryDirectory() as folder:
            paths = [write_log(folder, number, entries) for number, entries in enumerate(logs)]
            command = [sys.executable, sys.argv[1], *map(str, paths)]
            run = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        if run.stdout.splitlines()[-1] != line or run.returncode != code:
            wrong += 1
            print(f'{logs}: expected {line!r} and {code}, got {run.stdout!r} and {run.returncode}')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
