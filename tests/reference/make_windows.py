#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes windows.txt: windows, and what window_reference.py finds to be their optimum.

usage: make_windows.py > windows.txt      (needs numpy, scipy and clarabel)

Windows are synthetic walks, and stretches of the camera paths in motion/*.txt, which the library measured on real video
(one frame a line: a b x y of F_t, unit the diagonal). Format of windows.txt, one window after the other:

    window N HISTORY CROP WIDTH HEIGHT NAME
    past A B X Y                  HISTORY lines, newest last: P of the frames before the window, in its reference
    F A B X Y                     N lines; the first is not used
    lambda L OBJECTIVE            8 times, each followed by
    P T A B X Y                   P at every 16th frame and the last; left out where lambda is 0 (not unique)
"""
import glob
import os
import sys

import numpy as np

import window_reference as reference

LAMBDAS = (0, 0.01, 0.1, 0.5, 1, 2, 10, 100)
FULL = 150


def synthetic(n, rng, shake_px, pan_px, roll, zoom, width=640, height=360):
    """A camera that pans, drifts and shakes."""
    diagonal, t = np.hypot(width, height), np.arange(n)

    def shake(rms):
        kernel = np.exp(-np.arange(-6, 7) ** 2 / 8.0)
        return rms * np.convolve(rng.normal(size=n), kernel / np.sqrt((kernel ** 2).sum()), 'same')[:n]

    x = pan_px * t + 20 * np.sin(t / 40 + rng.uniform(0, 6)) + shake(shake_px)
    y = 8 * np.sin(t / 55 + rng.uniform(0, 6)) + shake(shake_px)
    angle, scale = shake(roll), np.exp(shake(zoom))
    poses = [reference.similarity((s * np.cos(a), s * np.sin(a), u / diagonal, v / diagonal))
             for s, a, u, v in zip(scale, angle, x, y)]
    motions = [np.eye(3)] + [np.linalg.inv(a) @ b for a, b in zip(poses, poses[1:])]
    return np.array([reference.parameters(m) for m in motions])


def past_of(motions, count, rng):
    """A smooth path that led to the window: near C, with a speed of its own."""
    speed = rng.normal(size=4) * [1e-4, 1e-4, 2e-3, 1e-3]
    base = np.array([1, 0, 0, 0]) + rng.normal(size=4) * [1e-3, 1e-3, 5e-3, 5e-3]
    return [base - speed * back for back in range(count, 0, -1)]


def windows():
    rng = np.random.default_rng(2013)
    for i in range(20):
        n = (FULL, FULL, 90, 40, 12)[i % 5] if i < 15 else (1, 2, 3, 4, 5)[i - 15]
        motions = synthetic(n, rng, *((2, 0.5, 0.002, 0.001), (6, 1, 0.01, 0.003), (12, 3, 0.02, 0.01),
                                      (30, -6, 0.04, 0.02))[i % 4])
        past = past_of(motions, (0, 3, 3, 1, 2)[i % 5], rng)
        yield f'synthetic-{i}', motions, past, (0.9, 0.8)[i % 2], 640, 360
    here = os.path.dirname(os.path.abspath(__file__))
    for path in sorted(glob.glob(os.path.join(here, 'motion', '*.txt'))):
        with open(path) as file:
            width, height = map(int, file.readline().split()[1:3])
        motions = np.loadtxt(path, skiprows=1)
        name = os.path.basename(path)[:-4]
        for k, first in enumerate((0, len(motions) // 3, max(0, len(motions) - FULL))):
            part = motions[first:first + FULL]
            past = past_of(part, 0 if first == 0 else 3, rng)
            yield f'{name}-{first}', part, past, (0.8, 0.9, 0.95)[k], width, height


def numbers(values):
    return ' '.join(f'{v:.12g}' for v in values)


def main():
    for name, motions, past, crop, width, height in windows():
        motions, past = np.round(motions, 9), [np.round(p, 9) for p in past]
        print('window', len(motions), len(past), crop, width, height, name)
        for p in past:
            print('past', numbers(p))
        for f in motions:
            print('F', numbers(f))
        for lam in LAMBDAS:
            objective, smooth = reference.solve(motions, past, lam, crop, width, height)
            print('lambda', lam, f'{objective:.13g}')
            for t in sorted(set(range(0, len(motions), 16)) | {len(motions) - 1}) if lam > 0 else ():
                print('P', t, numbers(smooth[t]))
        print(name, file=sys.stderr, flush=True)


if __name__ == '__main__':
    main()
