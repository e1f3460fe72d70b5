#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the text of files: check_style.py TREE | check_style.py --self-test

No file has tabs, trailing blanks, control characters or Windows line ends. Each ends with a newline. A source file
begins with the SPDX line, and its lines have at most 120 columns. No file has a path that one machine alone has.
"""
import re
import sys
from pathlib import Path

MAX_COLUMNS = 120

PLACES = ('.ci', 'docs', 'lib', 'packaging', 'plugin', 'samples', 'subprojects/packagefiles/osqp', 'tests')
SOURCE = {'.c', '.cpp', '.h', '.py', '.sh'}
TEXT = SOURCE | {'.html', '.md', '.build', '.map', '.pyi', '.toml', '.wrap', ''}
SPDX = 'SPDX-License-Identifier: MIT'
MACHINES_PATH = re.compile(r'(?<![\w.~$}\])>/-])/(?:home|root|work)\b')


def line_faults(lines):
    for number, line in enumerate(lines, 1):
        if re.search(r'[\x00-\x08\x0b-\x1f\x7f\u200b-\u200f\u202a-\u202e\ufeff]', line):
            yield number, 'an invisible character'
        if '\t' in line:
            yield number, 'a tab'
        if line != line.rstrip():
            yield number, 'trailing blanks'
        if MACHINES_PATH.search(line):
            yield number, 'a path of one machine'


def faults(name, text):
    """Yields the line and the description of each fault of a file."""
    suffix = Path(name).suffix
    lines = text.split('\n')
    if lines[-1] != '':
        yield len(lines), 'no newline at the end'
    lines = lines[:-1] if lines[-1] == '' else lines
    yield from line_faults(lines)

    source = suffix in SOURCE or name.endswith('meson.build')
    first = lines[1:2] if lines and lines[0].startswith('#!') else lines[0:1]
    if (source or lines and lines[0].startswith('#!')) and not (first and SPDX in first[0]):
        yield 1, f'no {SPDX}'
    if source:
        for number, line in enumerate(lines, 1):
            if len(line) > MAX_COLUMNS:
                yield number, f'{len(line)} columns, the limit is {MAX_COLUMNS}'


def check(tree):
    files = [p for place in PLACES for p in (tree / place).rglob('*') if p.is_file()]
    files += [p for p in tree.iterdir() if p.is_file()]
    files += [p for p in (tree / 'subprojects').iterdir() if p.is_file()]
    files = [p for p in files if p.suffix in TEXT and '__pycache__' not in p.parts]
    count = 0
    for file in sorted(files):
        for number, what in faults(file.name, file.read_text(encoding='utf-8')):
            count += 1
            print(f'{file.relative_to(tree)}:{number}: {what}')
    print(f'{len(files)} files, {count} faults')
    return 1 if count or not files else 0


def self_test():
    """Checks texts with known faults, which must all be found, and clean ones, which must pass."""
    head = f'/* {SPDX} */\n'
    clean = head + 'int f(void)\n{\n    f("$root/home", "a/work/b", "/homework");\n}\n'
    planted = [
        head + '\tint a;\n', head + 'int a; \n', head + 'int a;\r\n', head + 'int a;', 'int a;\n', '',
        head + 'int \u200ba;\n', head + f'/* see /{"home"}/me/clip */\n', head + f'run(" /{"work"}/build");\n',
        head + f'int {"a" * MAX_COLUMNS};\n',
    ]
    missed = [text[:60] for text in planted if not list(faults('a.c', text))]
    false_alarms = list(faults('a.c', clean)) + list(faults('README.md', 'a ' * 70 + 'b\n'))
    print(f'missed: {missed}, false alarms: {false_alarms}')
    return 1 if missed or false_alarms else 0


if __name__ == '__main__':
    sys.exit(self_test() if sys.argv[1] == '--self-test' else check(Path(sys.argv[1]).resolve()))
