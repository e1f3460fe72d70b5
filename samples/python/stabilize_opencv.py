#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Stabilizes a video with the frames of OpenCV: stabilize_opencv.py IN OUT.mp4"""
import sys

import cv2
import l1l2stab


def frames_of(capture):
    while True:
        ok, frame = capture.read()  # a new array each time, so the library may refer to it
        if not ok:
            return
        yield frame


def main(source, target):
    capture = cv2.VideoCapture(source)
    if not capture.isOpened():
        sys.exit(f'stabilize_opencv: {source} cannot be read')
    fps = capture.get(cv2.CAP_PROP_FPS)
    writer = None
    for frame in l1l2stab.stabilize(frames_of(capture), fps=fps):
        if writer is None:
            height, width = frame.shape[:2]
            writer = cv2.VideoWriter(target, cv2.VideoWriter_fourcc(*'mp4v'), fps, (width, height))
            if not writer.isOpened():
                sys.exit(f'stabilize_opencv: {target} cannot be written')
        writer.write(frame)
    if writer is not None:
        writer.release()


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit('usage: stabilize_opencv.py IN OUT.mp4')
    main(*sys.argv[1:])
