#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""ffmpeg with the filter under valgrind: no invalid access, no use of undefined values, no leak."""
import re
import shutil
import sys
import unittest

import small_ffmpeg

if not shutil.which('valgrind'):
    print('skipped: valgrind is not installed')
    sys.exit(small_ffmpeg.SKIPPED)

VALGRIND = ['valgrind', '--quiet', '--error-exitcode=99', '--leak-check=full', '--errors-for-leak-kinds=definite',
            '--show-leak-kinds=definite']
SIZE = 'testsrc2=size=96x64:rate=30'
CHANGE = "scale=w='if(lt(n,15),96,64)':h='if(lt(n,15),64,48)':eval=frame"


class Valgrind(unittest.TestCase):
    def clean(self, graph, threads=2, fails=False):
        _, messages = small_ffmpeg.run('-v', 'error', '-f', 'lavfi', '-i', SIZE, '-frames:v', 30, '-filter_threads',
                                       threads, '-vf', graph, '-f', 'null', '-', wrapper=VALGRIND, fails=fails,
                                       seconds=600)
        self.assertNotRegex(messages, re.compile('^==', re.MULTILINE))

    def test_a_whole_stream_is_clean(self):
        self.clean('format=yuv420p,l1l2stab=window=8')

    def test_ten_bits_and_packed_pixels_are_clean(self):
        self.clean('format=yuv420p10le,l1l2stab=window=8')
        self.clean('format=rgb24,l1l2stab=window=8:interpolation=lanczos')

    def test_a_stream_that_ends_within_the_window_is_clean(self):
        self.clean('format=yuv420p,l1l2stab=window=30,trim=end_frame=4')
        # What is lost cannot hide behind a thread that still refers to it.
        self.clean('format=yuv420p,trim=end_frame=3,l1l2stab', threads=1)

    def test_changes_and_commands_are_clean(self):
        self.clean(f"format=yuv420p,{CHANGE},sendcmd=c='0.3 l1l2stab bypass 1; 0.5 l1l2stab crop_ratio 0.8',"
                   'l1l2stab=window=8,scale=96:64')

    def test_a_refused_setting_is_clean(self):
        self.clean('format=yuv420p,l1l2stab=window=10:overlap=20', fails=True)


if __name__ == '__main__':
    unittest.main(verbosity=2)
