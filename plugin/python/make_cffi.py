#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the C source of the module l1l2stab._cffi: make_cffi.py PUBLIC_HEADER OUTPUT.c

Meson runs it. The declarations are read from the public header, so that nothing is stated twice. cffi reads no
preprocessor lines, so what remains of them are the constants, whose values the C compiler fills in.
"""
import re
import sys
from pathlib import Path

import cffi

# Called by the library, and written in Python: _library.py.
CALLBACKS = '''
extern "Python" void l1l2stab_python_log(void *cookie, L1L2StabLogLevel level, const char *message);
extern "Python" void l1l2stab_python_release(void *opaque);
'''


def declarations(header):
    """What cffi can read of the public header."""
    text = re.sub(r'/\*.*?\*/', '', header, flags=re.DOTALL)
    constants = re.findall(r'^#define (L1L2STAB_\w+) +[(\w]', text, flags=re.MULTILINE)
    constants = [name for name in constants if name not in ('L1L2STAB_API', 'L1L2STAB_MUST_CHECK')]
    text = re.sub(r'#ifdef __cplusplus\n.*?#endif', '', text, flags=re.DOTALL)
    text = re.sub(r'^#.*$', '', text, flags=re.MULTILINE)
    text = re.sub(r'\b(L1L2STAB_API|L1L2STAB_MUST_CHECK)\b', '', text)
    return text + ''.join(f'#define {name} ...\n' for name in constants)


def main():
    header, output = sys.argv[1:]
    ffi = cffi.FFI()
    ffi.cdef(declarations(Path(header).read_text(encoding='utf-8')) + CALLBACKS)
    ffi.set_source('l1l2stab._cffi', '#include <l1l2stab/l1l2stab.h>\n')
    ffi.emit_c_code(output)


if __name__ == '__main__':
    main()
