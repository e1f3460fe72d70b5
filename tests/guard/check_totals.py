#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The totals of tests/run.sh, on planted logs: check_totals.py TOTALS.PY"""
import json
import subprocess
import sys
import tempfile

CASES = [
    # (result, stdout) of each program; the last line; the exit code
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


def main():
    wrong = 0
    for entries, line, code in CASES:
        with tempfile.NamedTemporaryFile('w', suffix='.json') as log:
            for number, (result, stdout) in enumerate(entries):
                log.write(json.dumps({'name': str(number), 'result': result, 'stdout': stdout}) + '\n')
            log.flush()
            command = [sys.executable, sys.argv[1], log.name]
            run = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        if run.stdout.splitlines()[-1] != line or run.returncode != code:
            wrong += 1
            print(f'{entries}: expected {line!r} and {code}, came {run.stdout!r} and {run.returncode}')
    return 1 if wrong else 0


if __name__ == '__main__':
    sys.exit(main())
