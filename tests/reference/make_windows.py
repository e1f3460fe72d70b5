#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes windows.txt: windows, and their optimum as window_reference.py finds it.

usage: make_windows.py > windows.txt                (needs numpy, scipy and clarabel)
       make_windows.py --uneven > windows_uneven.txt  windows whose frames are not evenly spaced in time

Windows are synthetic walks, and stretches of the camera paths in motion/*.txt, which the library measured on real video
(one frame a line: a b x y of F_t, unit the diagonal), for the similarity; then a few for the other motion models.
Format of windows.txt, one window after the other, where P... stands for the DIM parameters of a map: x y (2), a b x y
of [a -b x; b a y] (4), or a b c d x y of [a b x; c d y] (6):

    window DIM N HISTORY CROP WIDTH HEIGHT NAME
    past P...                     HISTORY lines, newest last: P of the frames before the window, in its reference
    step H                        only of uneven windows; 2 + N lines: the steps to frame -2, -1, 0 ... N-1
    F P...                        N lines; the first is not used
    lambda L OBJECTIVE            8 times (4 of uneven windows), each followed by
    P T P...                      P at every 16th frame and the last; left out where lambda is 0 (not unique)
"""
import itertools
import os
import sys

import numpy as np

import window_reference as reference
from window_reference import Affine, Similarity, Translation

LAMBDAS = (0, 0.01, 0.1, 0.5, 1, 2, 10, 100)
FULL = 150
CLIPS = ('bag', 'dashcam-highway', 'fastpan-cat', 'handheld-shelf', 'hippo', 'liu09-video8-720p', 'roll-book',
         'snowboard-720p', 'walk-corridor')


def shaken(n, rng, rms):
    kernel = np.exp(-np.arange(-6, 7) ** 2 / 8.0)
    return rms * np.convolve(rng.normal(size=n), kernel / np.sqrt((kernel ** 2).sum()), 'same')[:n]


def synthetic(n, rng, shake_px, pan_px, roll, zoom, model=Similarity, width=640, height=360):
    """A camera that pans, drifts and shakes; an affine one also stretches and skews by half of its zoom."""
    diagonal, t = np.hypot(width, height), np.arange(n)
    x = pan_px * t + 20 * np.sin(t / 40 + rng.uniform(0, 6)) + shaken(n, rng, shake_px)
    y = 8 * np.sin(t / 55 + rng.uniform(0, 6)) + shaken(n, rng, shake_px)
    if model is Translation:
        poses = [Translation.matrix((u / diagonal, v / diagonal)) for u, v in zip(x, y)]
    else:
        angle, scale = shaken(n, rng, roll), np.exp(shaken(n, rng, zoom))
        poses = [Similarity.matrix((s * np.cos(a), s * np.sin(a), u / diagonal, v / diagonal))
                 for s, a, u, v in zip(scale, angle, x, y)]
    if model is Affine:
        poses = [m @ Affine.matrix((1 + e, f, f, 1 - e, 0, 0))
                 for m, e, f in zip(poses, shaken(n, rng, zoom / 2), shaken(n, rng, zoom / 2))]
    motions = [np.eye(3)] + [np.linalg.inv(a) @ b for a, b in zip(poses, poses[1:])]
    return np.array([model.parameters(m) for m in motions])


def past_of(count, rng, model=Similarity):
    """A smooth path that led to the window: near C, with a speed of its own."""
    linear = model.dim - 2
    speed = rng.normal(size=model.dim) * ([1e-4] * linear + [2e-3, 1e-3])
    base = model.parameters(np.eye(3)) + rng.normal(size=model.dim) * ([1e-3] * linear + [5e-3, 5e-3])
    return [base - speed * back for back in range(count, 0, -1)]


def measured():
    here = os.path.dirname(os.path.abspath(__file__))
    for name in CLIPS:
        path = os.path.join(here, 'motion', name + '.txt')
        with open(path) as file:
            width, height = map(int, file.readline().split()[1:3])
        yield name, np.loadtxt(path, skiprows=1), width, height


SHAKES = ((2, 0.5, 0.002, 0.001), (6, 1, 0.01, 0.003), (12, 3, 0.02, 0.01), (30, -6, 0.04, 0.02))


def similarity_windows():
    rng = np.random.default_rng(2013)
    for i in range(20):
        n = (FULL, FULL, 90, 40, 12)[i % 5] if i < 15 else (1, 2, 3, 4, 5)[i - 15]
        motions = synthetic(n, rng, *SHAKES[i % 4])
        past = past_of((0, 3, 3, 1, 2)[i % 5], rng)
        yield Similarity, f'synthetic-{i}', motions, past, (0.9, 0.8)[i % 2], 640, 360
    for name, motions, width, height in measured():
        for k, first in enumerate((0, len(motions) // 3, max(0, len(motions) - FULL))):
            part = motions[first:first + FULL]
            past = past_of(0 if first == 0 else 3, rng)
            yield Similarity, f'{name}-{first}', part, past, (0.8, 0.9, 0.95)[k], width, height


def other_windows():
    rng = np.random.default_rng(2011)
    for model, lengths in ((Affine, (FULL, 90, 40, 40, 12, 3, 2, 1)), (Translation, (FULL, 40, 12, 3, 1))):
        for i, n in enumerate(lengths):
            motions = synthetic(n, rng, *SHAKES[i % 4], model)
            past = past_of((0, 3, 3, 1, 2, 3)[i % 6], rng, model)
            yield model, f'{model.__name__.lower()}-{i}', motions, past, (0.9, 0.8)[i % 2], 640, 360
    for name, motions, width, height in measured():
        if name in ('bag', 'fastpan-cat'):  # similarities are affine, too: the limits then let B stretch
            part = np.array([Affine.parameters(Similarity.matrix(f)) for f in motions[:90]])
            yield Affine, f'affine-{name}', part, past_of(3, rng, Affine), 0.9, width, height


def uneven_steps(kind, n, rng):
    """Steps to frame -2 ... n - 1: one frame in five missing, the whole range at random, or a rate that changes."""
    if kind == 0:
        return np.where(np.arange(n + 2) % 4 == 1, 2.0, 1.0)
    if kind == 1:
        return np.exp(rng.uniform(np.log(0.25), np.log(4), n + 2))
    return np.where(np.arange(n + 2) < n / 2, 0.25, rng.uniform(0.8, 1.2, n + 2))


def uneven_windows():
    rng = np.random.default_rng(2027)
    for model, lengths in ((Similarity, (FULL, 90, 90, 40, 40, 12, 3, 1)), (Affine, (40, 40, 12)),
                           (Translation, (FULL, 40, 12))):
        for i, n in enumerate(lengths):
            motions = synthetic(n, rng, *SHAKES[i % 4], model)
            past = past_of((3, 0, 3, 2, 1, 3, 3, 3)[i], rng, model)
            steps = np.round(uneven_steps(i % 3, n, rng), 6)
            yield model, f'uneven-{model.__name__.lower()}-{i}', motions, past, steps


def print_uneven():
    for model, name, motions, past, steps in uneven_windows():
        motions, past = np.round(motions, 9), [np.round(p, 9) for p in past]
        print('window', model.dim, len(motions), len(past), 0.9, 640, 360, name)
        for p in past:
            print('past', numbers(p))
        for h in steps:
            print('step', numbers([h]))
        for f in motions:
            print('F', numbers(f))
        times = np.concatenate([[0], np.cumsum(steps)])[3 - len(past):]
        for lam in LAMBDAS[1:5]:
            objective, smooth = reference.solve(motions, past, lam, 0.9, 640, 360, model, times)
            print('lambda', lam, f'{objective:.13g}')
            for t in sorted(set(range(0, len(motions), 16)) | {len(motions) - 1}):
                print('P', t, numbers(smooth[t]))
        print(name, file=sys.stderr, flush=True)


def numbers(values):
    return ' '.join(f'{v:.12g}' for v in values)


def main():
    for model, name, motions, past, crop, width, height in itertools.chain(similarity_windows(), other_windows()):
        motions, past = np.round(motions, 9), [np.round(p, 9) for p in past]
        print('window', model.dim, len(motions), len(past), crop, width, height, name)
        for p in past:
            print('past', numbers(p))
        for f in motions:
            print('F', numbers(f))
        for lam in LAMBDAS:
            objective, smooth = reference.solve(motions, past, lam, crop, width, height, model)
            print('lambda', lam, f'{objective:.13g}')
            for t in sorted(set(range(0, len(motions), 16)) | {len(motions) - 1}) if lam > 0 else ():
                print('P', t, numbers(smooth[t]))
        print(name, file=sys.stderr, flush=True)


if __name__ == '__main__':
    print_uneven() if '--uneven' in sys.argv[1:] else main()
