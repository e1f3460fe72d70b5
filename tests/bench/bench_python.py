#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Informational: frames through stabilize() in Python, beside the same loop in C.

usage: bench_python.py LOOP_PROGRAM [WIDTH HEIGHT]      default: 1920 1080

Both programs process the same frames, in turn and several times. On a machine that does other work, the CPU time is
the one to compare. In C, and in the line "given array", all frames are rendered into the same memory. Otherwise each
frame gets a new array.
"""
import subprocess
import sys
import tempfile
import time
import warnings

import l1l2stab
import numpy as np

WIDTH, HEIGHT = map(int, sys.argv[2:4] or (1920, 1080))
CLIP, PLAYED, RUNS = 24, 250, 5


def make_clip():
    """BGR frames: a textured scene, seen by a camera that shakes by up to 12 pixels."""
    dice = np.random.default_rng(1)
    scene = np.zeros((HEIGHT + 32, WIDTH + 32, 3))
    for tile in (4, 8, 16, 32, 64):
        coarse = dice.uniform(0, 50, (scene.shape[0] // tile + 1, scene.shape[1] // tile + 1, 3))
        scene += np.kron(coarse, np.ones((tile, tile, 1)))[:scene.shape[0], :scene.shape[1]]
    scene = scene.astype(np.uint8)
    return [scene[y:y + HEIGHT, x:x + WIDTH].copy() for x, y in dice.integers(0, 25, (CLIP, 2))]


def to_i420(frame):
    planes = frame[..., 1], frame[::2, ::2, 0], frame[::2, ::2, 2]
    return np.concatenate([plane.reshape(-1) for plane in planes]).reshape(HEIGHT * 3 // 2, WIDTH)


def played(clip):
    period = 2 * CLIP - 2
    for t in range(PLAYED):
        yield clip[min(t % period, period - t % period)]


def python_ms(clip, format, out=None):
    """Wall and CPU time per frame."""
    begin = time.perf_counter(), time.process_time()
    count = sum(1 for _ in l1l2stab.stabilize(played(clip), 30, format=format, out=out))
    assert count == PLAYED
    return 1e3 * (time.perf_counter() - begin[0]) / PLAYED, 1e3 * (time.process_time() - begin[1]) / PLAYED


def c_ms(program, path, format):
    arguments = [program, path, format, str(WIDTH), str(HEIGHT), str(PLAYED)]
    line = subprocess.run(arguments, stdout=subprocess.PIPE, check=True, text=True).stdout
    return tuple(map(float, line.split()))


def measure(program, frames, format):
    """For C, Python, and Python with a given array: the least wall and the least CPU time per frame."""
    given = np.empty_like(frames[0])
    with tempfile.NamedTemporaryFile() as file:
        for frame in frames:
            file.write(frame.tobytes())
        file.flush()
        runs = [(c_ms(program, file.name, format), python_ms(frames, format), python_ms(frames, format, given))
                for _ in range(RUNS)]
    return [tuple(map(min, zip(*times))) for times in zip(*runs)]


def main():
    warnings.simplefilter('ignore', RuntimeWarning)  # frames are pushed again while they are held, and do not change
    program, clip = sys.argv[1], make_clip()
    print(f'{WIDTH}x{HEIGHT}, ms per frame: the least of {RUNS} runs of {PLAYED} frames')
    print('                          wall          CPU')
    for format, frames in ('BGR', clip), ('I420', [to_i420(frame) for frame in clip]):
        results = measure(program, frames, format)
        for name, times in zip(('C', 'Python', 'Python, given array'), results):
            rates = '   '.join(f'{ms:6.2f} {100 * c / ms:4.0f} %' for ms, c in zip(times, results[0]))
            print(f'{format:5} {name:20} {rates}')


if __name__ == '__main__':
    main()
