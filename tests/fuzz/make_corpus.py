#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the first inputs of a fuzz target: make_corpus.py TARGET FOLDER

Random bytes with fixed seeds and of different lengths make long runs of calls; the inputs in FOUND once broke something.
"""
import random
import sys
from pathlib import Path

# Inputs that once broke something, in hexadecimal, by target.
FOUND = {
    'api': [],
    'motions': [],
}


def random_inputs(count):
    generator = random.Random(5)
    for number in range(count):
        yield f'random-{number}', generator.randbytes(32 << (number % 4))


def main():
    target, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    inputs = list(random_inputs(12)) + [(f'found-{n}', bytes.fromhex(text)) for n, text in enumerate(FOUND[target])]
    for name, data in inputs:
        (folder / name).write_bytes(data)


if __name__ == '__main__':
    main()
