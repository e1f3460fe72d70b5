#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Stabilizes a video with the frames of PyAV: stabilize_pyav.py IN OUT.mp4

No picture is copied or converted: the library reads the decoder's planes and renders into those of the encoder. Each
frame keeps its time, so that videos with a variable frame rate are right. Sound is not kept.
"""
import sys

import av
import l1l2stab
import numpy as np

FORMATS = {'yuv420p': 'I420', 'yuv422p': 'Y42B', 'yuv444p': 'Y444', 'yuv420p10le': 'I420_10LE'}


def planes_of(frame):
    """The planes of a frame as arrays that share its memory. A plane keeps its frame alive, and an array its plane."""
    dtype = np.dtype('<u2' if '10' in frame.format.name else 'u1')
    arrays = []
    for plane in frame.planes:
        rows = np.frombuffer(plane, dtype).reshape(-1, plane.line_size // dtype.itemsize)
        arrays.append(rows[:plane.height, :plane.width])
    return tuple(arrays)


class Writer:
    """Renders what is ready into new frames, and encodes them."""

    def __init__(self, container, source):
        self.container, self.time_base = container, source.time_base
        self.stream = container.add_stream('libx264', rate=source.average_rate)
        self.stream.pix_fmt, self.stream.codec_context.time_base = source.pix_fmt, source.time_base
        self.stream.width, self.stream.height = source.width, source.height

    def write_ready(self, stabilizer):
        width, height = stabilizer.output_size
        while True:
            frame = av.VideoFrame(width, height, self.stream.pix_fmt)
            output = stabilizer.pull(out=planes_of(frame))
            if output is None:
                return
            frame.pts, frame.time_base = output.tag, self.time_base
            self.container.mux(self.stream.encode(frame))


def main(source_name, target_name):
    with av.open(source_name) as source, av.open(target_name, 'w') as target:
        video = source.streams.video[0]
        if video.pix_fmt not in FORMATS:
            sys.exit(f'stabilize_pyav: {video.pix_fmt} is none of {", ".join(FORMATS)}')
        writer = Writer(target, video)
        with l1l2stab.Stabilizer(video.width, video.height, FORMATS[video.pix_fmt], video.average_rate) as stabilizer:
            for frame in source.decode(video):
                nanoseconds = None if frame.pts is None else round(frame.pts * frame.time_base * 10**9)
                stabilizer.push(planes_of(frame), pts=nanoseconds, tag=frame.pts)
                writer.write_ready(stabilizer)
            stabilizer.finish()
            writer.write_ready(stabilizer)
        target.mux(writer.stream.encode(None))


if __name__ == '__main__':
    if len(sys.argv) != 3:
        sys.exit('usage: stabilize_pyav.py IN OUT.mp4')
    main(*sys.argv[1:])
