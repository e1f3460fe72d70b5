#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Four pictures of one frame of a video, in one: as filmed, cropped, whole with its border filled, and who gave each
pixel (gray: the frame itself; blue: earlier frames; orange: later ones; black: nobody).

full_frame_opencv.py IN OUT.png [FRAME]"""
import itertools
import sys

import cv2
import l1l2stab
import numpy as np

EARLIER, LATER = (200, 120, 40), (40, 140, 240)


def frames_of(path):
    capture = cv2.VideoCapture(path)
    if not capture.isOpened():
        sys.exit(f'full_frame_opencv: {path} cannot be read')
    while True:
        ok, frame = capture.read()
        if not ok:
            return
        yield frame


def painted(who, picture):
    """The map in colors, over the picture in gray."""
    gray = cv2.cvtColor(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)
    colors = gray // 2 + 100
    distance = who.astype(int) - 128
    for chosen, color in (((who != 0) & (distance < 0), EARLIER), ((who != 255) & (distance > 0), LATER)):
        near = np.clip(1.0 - np.abs(distance[chosen]) / 40.0, 0.2, 1.0)
        colors[chosen] = (near[:, None] * np.array(color)).astype(np.uint8)
    colors[who == 255] = 0
    return colors


def stabilized(path, number, border):
    """The frame, and its map if there is one."""
    frames = frames_of(path)
    first = next(frames)
    height, width = first.shape[:2]
    with l1l2stab.Stabilizer(width, height, 'BGR', border=border, crop_ratio=0.85) as stabilizer:
        for frame in itertools.chain([first], frames):
            stabilizer.push(frame)
            for output in stabilizer.ready():
                if output.info.index == number:
                    return output.picture, None if border == 'crop' else stabilizer.border_map()
        stabilizer.finish()
        for output in stabilizer.ready():
            if output.info.index == number:
                return output.picture, None if border == 'crop' else stabilizer.border_map()
    sys.exit(f'full_frame_opencv: {path} has no frame {number}')


def main(source, target, number=40):
    filled, who = stabilized(source, number, 'fill')
    cropped, _ = stabilized(source, number, 'crop')
    filmed = next(itertools.islice(frames_of(source), number, None))
    rows = [np.hstack([filmed, cropped]), np.hstack([filled, painted(who, filled)])]
    if not cv2.imwrite(target, np.vstack(rows)):
        sys.exit(f'full_frame_opencv: {target} cannot be written')


if __name__ == '__main__':
    if len(sys.argv) not in (3, 4):
        sys.exit('usage: full_frame_opencv.py IN OUT.png [FRAME]')
    main(sys.argv[1], sys.argv[2], *map(int, sys.argv[3:]))
