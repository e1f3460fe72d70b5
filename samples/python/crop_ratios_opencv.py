#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Four pictures of one frame of a video, in one: as filmed, and stabilized with the crop ratios 0.95, 0.9 and 0.8.

crop_ratios_opencv.py IN OUT.jpg [FRAME]"""
import itertools
import sys

import cv2
import l1l2stab
import numpy as np

CROP_RATIOS = (0.95, 0.9, 0.8)


def frames_of(path):
    capture = cv2.VideoCapture(path)
    if not capture.isOpened():
        sys.exit(f'crop_ratios_opencv: {path} cannot be read')
    while True:
        ok, frame = capture.read()
        if not ok:
            return
        yield frame


def picked(frames, number, path):
    """The frame of this number, counted from 0."""
    frame = next(itertools.islice(frames, number, None), None)
    if frame is None:
        sys.exit(f'crop_ratios_opencv: {path} has no frame {number}')
    return frame.copy()


def labeled(picture, text):
    for color, width in (((0, 0, 0), 5), ((255, 255, 255), 2)):
        cv2.putText(picture, text, (12, 30), cv2.FONT_HERSHEY_SIMPLEX, 0.8, color, width, cv2.LINE_AA)
    return picture


def main(source, target, number=40):
    pictures = [labeled(picked(frames_of(source), number, source), 'as filmed')]
    for ratio in CROP_RATIOS:
        stabilized = l1l2stab.stabilize(frames_of(source), fps=30, crop_ratio=ratio)
        pictures.append(labeled(picked(stabilized, number, source), f'crop-ratio {ratio}'))
    whole = np.vstack([np.hstack(pictures[:2]), np.hstack(pictures[2:])])
    if not cv2.imwrite(target, whole, [cv2.IMWRITE_JPEG_QUALITY, 80]):
        sys.exit(f'crop_ratios_opencv: {target} cannot be written')


if __name__ == '__main__':
    if len(sys.argv) not in (3, 4):
        sys.exit('usage: crop_ratios_opencv.py IN OUT.jpg [FRAME]')
    main(sys.argv[1], sys.argv[2], *map(int, sys.argv[3:]))
