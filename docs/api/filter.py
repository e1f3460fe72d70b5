#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Prints a header with its plain comments as those of Doxygen, which reads only the ones that are marked.

A comment behind code describes that code; any other describes what follows. The comment at the top, behind the SPDX
line, is the main page. It is laid out by hand, so its lines and columns are kept.
"""
import re
import sys

SPDX = re.compile(r'/\* SPDX.*?\*/\n')


def mark(line):
    code, opening, comment = line.replace('eq. (', 'eq.\\ (').partition('/*')  # this dot does not end the summary
    if not opening:
        return line
    return f'{code}/**<{comment}' if code.strip() else f'{code}/**{comment}'


def top(comment):
    text = re.sub(r'^ \* ?', '', comment, flags=re.MULTILINE).strip()
    return ('/** \\file\nThe interface of the library. */\n'
            '/** \\mainpage l1l2stab.h\n\\verbatim\n' + text + '\n\\endverbatim\n*/\n')


header = SPDX.sub('', open(sys.argv[1], encoding='utf-8').read(), count=1)
begin, end = header.index('/*\n') + 3, header.index(' */\n')
print(top(header[begin:end]) + '\n'.join(mark(line) for line in header[end + 4:].split('\n')), end='')
