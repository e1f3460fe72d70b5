#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Stabilizes a video with the frames of imageio: stabilize_imageio.py IN OUT.mp4

imageio runs ffmpeg to read and write the files: `pip install imageio imageio-ffmpeg`.
"""
import sys

import l1l2stab

try:
    import imageio.v2 as imageio
except ImportError:  # before imageio 2.16
    import imageio


def main(source, target):
    reader = imageio.get_reader(source, format='FFMPEG')
    fps = reader.get_meta_data()['fps']
    with imageio.get_writer(target, format='FFMPEG', fps=fps, macro_block_size=2) as writer:
        for frame in l1l2stab.stabilize(reader, fps=fps, format='RGB'):
            writer.append_data(frame)


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit('usage: stabilize_imageio.py IN OUT.mp4')
    main(*sys.argv[1:])
