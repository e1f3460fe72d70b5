#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Adds up test runs: totals.py BUILD/meson-logs/testlog.json...

Each test of a Check program counts, according to Check's last line of output. Any other program counts as one test. The
last line of output is "N passed, N failed, N skipped". The exit code is 1 if a test failed, or if one of the logs is
missing or has no test that passed.
"""
import json
import re
import sys

# A Check program may have several runners. Each prints this line at its end.
CHECK_LINE = re.compile(r'^\d+%: Checks: (\d+), Failures: (\d+), Errors: (\d+)', re.MULTILINE)


def count(entry):
    """The (passed, failed, skipped) tests of one program."""
    totals = [tuple(map(int, match)) for match in CHECK_LINE.findall(entry.get('stdout') or '')]
    checks = sum(total[0] for total in totals)
    bad = sum(total[1] + total[2] for total in totals)
    if entry['result'] in ('OK', 'EXPECTEDFAIL'):
        # A Check program that ran no test counts as a failure.
        return (0, 1, 0) if totals and checks == 0 else (max(checks, 1), 0, 0)
    if entry['result'] == 'SKIP':
        return 0, 0, 1
    # If the program was killed, timed out or crashed before its last line, at least one test failed.
    return checks - bad, max(bad, 1), 0


def read_log(path):
    """The entries of one log: a JSON object per line. A missing log has none."""
    try:
        with open(path, encoding='utf-8') as log:
            return [json.loads(line) for line in log if line.strip()]
    except OSError as error:
        print(f'no test ran: {error}', file=sys.stderr)
        return []


def main():
    total = [0, 0, 0]
    complete = len(sys.argv) > 1
    print()
    for path in sys.argv[1:]:
        passed_here = 0
        for entry in read_log(path):
            counts = count(entry)
            total = [sum(pair) for pair in zip(total, counts)]
            passed_here += counts[0]
            if counts[1]:
                print(f'failed: {entry["name"]} ({entry["result"]})')
        complete = complete and passed_here > 0
    print('{} passed, {} failed, {} skipped'.format(*total))
    return 0 if complete and total[1] == 0 else 1


if __name__ == '__main__':
    sys.exit(main())
