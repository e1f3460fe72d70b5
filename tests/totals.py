#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Adds up a test run: totals.py BUILD/meson-logs/testlog.json

Counts the single tests of each Check program, from Check's own closing line, and every other program as one test. The
last line is "N passed, N failed, N skipped". The exit code is 1 if a test failed or none ran.
"""
import json
import re
import sys

# A suite may run several Check runners: each closes with this line.
CHECK_LINE = re.compile(r'^\d+%: Checks: (\d+), Failures: (\d+), Errors: (\d+)', re.MULTILINE)


def count(entry):
    """The (passed, failed, skipped) tests of one program."""
    totals = [tuple(map(int, match)) for match in CHECK_LINE.findall(entry.get('stdout') or '')]
    checks = sum(total[0] for total in totals)
    bad = sum(total[1] + total[2] for total in totals)
    if entry['result'] in ('OK', 'EXPECTEDFAIL'):
        # A Check program without a single check has tested nothing.
        return (0, 1, 0) if totals and checks == 0 else (max(checks, 1), 0, 0)
    if entry['result'] == 'SKIP':
        return 0, 0, 1
    # Killed, timed out or crashed before its closing line: at least one test failed.
    return checks - bad, max(bad, 1), 0


def main():
    try:
        with open(sys.argv[1], encoding='utf-8') as log:
            entries = [json.loads(line) for line in log if line.strip()]
    except OSError as error:
        print(f'no test ran: {error}', file=sys.stderr)
        entries = []

    counts = [count(entry) for entry in entries]
    passed, failed, skipped = (sum(column) for column in zip(*counts)) if counts else (0, 0, 0)
    print()
    for entry, (_, bad, _) in zip(entries, counts):
        if bad:
            print(f'failed: {entry["name"]} ({entry["result"]})')
    print(f'{passed} passed, {failed} failed, {skipped} skipped')
    return 1 if failed or passed == 0 else 0


if __name__ == '__main__':
    sys.exit(main())
