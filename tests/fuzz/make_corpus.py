#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the first inputs of a fuzz target: make_corpus.py TARGET FOLDER

Random bytes with fixed seeds and of different lengths make runs of calls. The readers of files get files instead. The
inputs in FOUND once broke something.
"""
import random
import sys
from pathlib import Path

# Inputs that once broke something, in hexadecimal, by target.
FOUND = {}

MOTION = b'l1l2stab-motion 1\n'
MOTION_FILES = [
    MOTION + b'size 64 48\nframerate 25/1\n# comment\n0 1 none 0 0 0 1 0 0 0 1 0\n'
    b'40000000 0 similarity 0.93 187 180 1.0001 -0.0002 3.25 0.0002 1.0001 -0.5\n'
    b'80000000 0 alignment 1 20 10 1 0 0x1.8p3 0 1 -1e1\n',
    MOTION + b''.join(b'- 0 given 1 0 0 1 0 2 0 1 -2\n' for _ in range(5)),
    MOTION + b'0 0 given 1 0 0 2 0 0 0 2 0\n' + 3 * b'40000000 0 given 1 0 0 2 0 0 0 2 0\n',
    MOTION + b'9223372036854775807 1 predicted 0 0 0 1e150 0 0 0 1e150 1e308\n',
    b'l1l2stab-motion 2\n',
]
MASKS = [
    b'P5 4 4 255\n' + bytes(16), b'P5\n# comment\n2 2\n255\n\x00\xff\xff\x00', b'P5 2 1 65535\n\x80\x00\x7f\xff',
    b'P5 16384 16384 255\n', b'P5 99999999999 1 1\n', b'P6 1 1 255\n',
]
REGIONS = [b'10%,0,80%,50%', b'0,0,64,48', b' 1.5 , 2 , 1e1 , 20% ', b'1e308,-1e308,nan,inf', b',,,']


def random_inputs(count):
    generator = random.Random(5)
    for number in range(count):
        yield generator.randbytes(32 << (number % 4))


def inputs(target):
    if target == 'motion_file':
        return [choices[:32].ljust(32, b'\1') + text
                for text, choices in zip(MOTION_FILES, random_inputs(len(MOTION_FILES)))]
    if target == 'mask_file':
        return [b'\0' + mask for mask in MASKS] + [b'\1' + region for region in REGIONS]
    return list(random_inputs(12))


def main():
    target, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    for number, data in enumerate(inputs(target)):
        (folder / f'first-{number}').write_bytes(data)
    for number, text in enumerate(FOUND.get(target, [])):
        (folder / f'found-{number}').write_bytes(bytes.fromhex(text))


if __name__ == '__main__':
    main()
