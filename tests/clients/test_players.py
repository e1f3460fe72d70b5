#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Players: l1l2stab in the sink of gst-play-1.0, driven by its keys, and as playbin's video filter, with all rates."""
import math
import os
import pty
import random
import re
import select
import subprocess
import time
import unittest

import clip
from clip import FPS, FRAME, Gst

clip.begin('gst-play-1.0', elements=('playbin', 'fakevideosink'))
folder = clip.folder()
FRAMES = 90
film = clip.make(folder / 'film.mov', FRAMES, audio=True)
KEY_SECONDS = 0.6
RIGHT, LEFT = b'\x1b[C', b'\x1b[D'


class GstPlay(unittest.TestCase):
    """The stats tracer logs what leaves the element, so nothing has to be added to the pipeline."""

    def play(self, path, *keys):
        """In a terminal, presses a key every KEY_SECONDS and waits for the end. Returns the times of the frames."""
        trace = folder / 'trace'
        ours, players = pty.openpty()
        player = subprocess.Popen(
            ['gst-play-1.0', '--videosink=l1l2stab window=10 ! fakevideosink', '--audiosink=fakesink sync=true', path],
            stdin=players, stdout=players, stderr=players, env={
                **os.environ, 'GST_TRACERS': 'stats', 'GST_DEBUG': 'GST_TRACER:7', 'GST_DEBUG_NO_COLOR': '1',
                'GST_DEBUG_FILE': str(trace)})
        os.close(players)
        keys, output, due = list(keys), b'', None
        while player.poll() is None:
            if select.select([ours], [], [], 0.05)[0]:
                try:
                    output += os.read(ours, 65536)
                except OSError:  # it has gone
                    break
            if due is None and b'Prerolled' in output:
                due = time.monotonic() + KEY_SECONDS
            if keys and due and time.monotonic() > due:
                os.write(ours, keys.pop(0))
                due = time.monotonic() + KEY_SECONDS
        self.assertEqual(player.wait(10), 0, output)
        os.close(ours)
        return self.stabilized(trace.read_text(errors='replace'))

    def stabilized(self, trace):
        """The times of the frames that left l1l2stab, in frames."""
        index = re.search(r'new-element,.* ix=\(uint\)(\d+),.*type=\(string\)GstL1L2Stab', trace)[1]
        left = re.compile(rf'buffer, .*[^-]element-ix=\(uint\){index},.*buffer-pts=\(guint64\)(\d+)')
        times = [int(match[1]) / FRAME for line in trace.splitlines() if (match := left.search(line))]
        # The first frame's time in this file.
        return [t - min(times) for t in times]

    def test_a_file_is_played_to_its_end_with_each_frame_once(self):
        times = self.play(film)
        self.assertEqual(len(times), FRAMES)
        for i, frame in enumerate(times):
            self.assertAlmostEqual(frame, i, delta=0.01)

    def test_the_keys_for_seek_rate_and_direction_give_consecutive_frames(self):
        times = self.play(film, RIGHT, LEFT, b'+', b'd', b'q')
        # The first frame after a seek is clipped to begin at the target, so it may round to the number of the next one.
        numbers = [math.floor(t + 0.01) for t in times]
        steps = ''.join({1: '+', -1: '-'}.get(b - a, '|') for a, b in zip(numbers, numbers[1:]))
        # From the beginning; later; earlier; faster, from about the same frame on; backward.
        self.assertRegex(steps, r'^\+{5,}\|{1,2}\+{5,}\|{1,2}\+{5,}[-|]{0,2}\+{5,}[-|]?-{5,}$')


class Playbin(unittest.TestCase):
    """playbin gives the same frames as without a filter, each once, in order, and stabilized."""

    SEGMENTS = [  # rate, first frame, end or None for the film's, what playbin then shows
        (1, 15, None, [*range(15, FRAMES)]),
        (2, 30, 45, [*range(30, 45)]),
        (0.5, 80, None, [*range(80, FRAMES)]),
        (-1, 0, 45, [*range(44, -1, -1)]),
        (-1, 0, FRAMES, [*range(FRAMES - 1, -1, -1)]),
        (1, 85, None, [*range(85, FRAMES)]),
    ]

    def open(self, stabilizer):
        self.pipeline = Gst.parse_launch(f'playbin uri={film.as_uri()} audio-sink=fakesink')
        self.addCleanup(self.pipeline.set_state, Gst.State.NULL)
        if stabilizer:
            self.pipeline.set_property('video-filter', Gst.parse_bin_from_description(stabilizer, True))
        viewer = Gst.parse_bin_from_description(
            'videoconvert ! video/x-raw,format=GRAY8 ! appsink name=sink sync=false max-buffers=4', True)
        self.sink = viewer.get_by_name('sink')
        self.pipeline.set_property('video-sink', viewer)
        self.pipeline.set_state(Gst.State.PLAYING)
        self.pipeline.get_state(10 * Gst.SECOND)

    def frames(self, count=None):
        """The next frames, or all that are left."""
        frames = []
        while len(frames) != count and (sample := self.sink.emit('try-pull-sample', 15 * Gst.SECOND)):
            frames.append(clip.frame_of(sample))
        return frames

    def seek(self, rate, first, end):
        # Rounded up: a time before the frame's own belongs to the frame before it.
        start, stop = (-(-frame * Gst.SECOND // FPS) for frame in (first, end or FRAMES))
        self.assertTrue(self.pipeline.seek(rate, Gst.Format.TIME, Gst.SeekFlags.FLUSH | Gst.SeekFlags.ACCURATE,
                                           Gst.SeekType.SET, start, Gst.SeekType.SET, stop))

    def check_segments(self, stabilizer):
        self.open(stabilizer)
        self.assertEqual([f.number for f in self.frames(3)], [0, 1, 2])
        for rate, first, end, numbers in self.SEGMENTS:
            self.seek(rate, first, end)
            frames = self.frames()
            self.assertEqual([f.number for f in frames], numbers, f'rate {rate}, from {first} to {end}')
            for frame in frames:
                self.assertAlmostEqual(frame.time / FRAME, frame.number, delta=0.01)

    def test_without_a_filter_all_rates_give_these_frames(self):
        self.check_segments(None)

    def test_all_rates_and_seeks_give_each_frame_once_in_order(self):
        self.check_segments('l1l2stab window=10')

    def test_a_window_longer_than_the_segments_gives_each_frame_once_in_order(self):
        self.check_segments('l1l2stab')

    def test_the_picture_is_stable_forward_and_backward(self):
        self.open(None)
        shaken = clip.unrest(self.frames())
        self.open('l1l2stab')
        self.assertLess(clip.unrest(self.frames()), 0.2 * shaken)
        self.seek(-1, 0, FRAMES)
        self.assertLess(clip.unrest(self.frames()), 0.2 * shaken)

    def test_fifty_fast_seeks_give_the_right_frames(self):
        dice = random.Random(3)
        self.open('l1l2stab window=10')
        for _ in range(50):
            self.seek(dice.choice([1, 1, 2, 0.5, -1]), dice.randrange(FRAMES - 5), None)
        self.seek(1, 50, 70)
        # What was there before the last seek may still come.
        self.assertEqual([f.number for f in self.frames()][-20:], [*range(50, 70)])


if __name__ == '__main__':
    unittest.main(verbosity=2)
