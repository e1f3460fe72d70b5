#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""OpenCV's VideoCapture reads stabilized frames from C++: test_opencv.py READER, the program of opencv_reader.cpp."""
import subprocess
import sys
import unittest

import clip

READER = sys.argv.pop(1) if len(sys.argv) > 1 else None
if not READER:
    print('skipped: not built, because libopencv-videoio-dev is missing')
    sys.exit(clip.SKIPPED)
clip.begin()
FRAMES = 60
film = clip.make(clip.folder() / 'film.mov', FRAMES)
PIPELINE = (f'filesrc location={film} ! decodebin ! l1l2stab window=20 ! videoconvert ! video/x-raw,format=BGR ! '
            'appsink sync=false')


def numbers(*arguments):
    """The numbers of the frames that the program read."""
    output = subprocess.run([READER, *map(str, arguments)], stdout=subprocess.PIPE, timeout=30, check=True).stdout
    found = []
    while output:
        line, output = output.split(b'\n', 1)
        width, height = map(int, line.split())
        found.append(clip.read_number(output, width, height))
        output = output[width * height:]
    return found


# The times that VideoCapture reports are not tested: it warns that they run ahead of the frames.
class OpenCV(unittest.TestCase):
    def test_it_reads_every_frame_to_the_end(self):
        self.assertEqual(numbers(PIPELINE), [*range(FRAMES)])

    def test_it_can_close_while_frames_are_held(self):
        self.assertEqual(numbers(PIPELINE, 5), [*range(5)])

    def test_it_can_close_before_the_first_frame(self):
        self.assertEqual(numbers(PIPELINE, 0), [])


if __name__ == '__main__':
    unittest.main(verbosity=2)
