#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Python bindings: properties, controllers and messages, checked by the output frames."""
import sys
import unittest

import clip
from clip import FPS, Gst

clip.begin()
try:
    import gi
    gi.require_version('GstController', '1.0')
    from gi.repository import GLib, GstController
except (ImportError, ValueError) as reason:
    print('skipped:', reason)
    sys.exit(clip.SKIPPED)

FRAMES = 160
folder = clip.folder()
film = clip.make(folder / 'film.mov', FRAMES)


def magnification(sample):
    """The zoom of a picture with a number that begins with the bits 1001, from the width of the dark blocks."""
    width, height = clip.WIDTH, clip.HEIGHT
    luma = sample.get_buffer().extract_dup(0, width * height)
    row = luma[(height // 2 - clip.BLOCK // 2) * width:][:width]
    first = last = width // 2
    while row[first - 1] < clip.MIDDLE:
        first -= 1
    while row[last + 1] < clip.MIDDLE:
        last += 1
    return (last - first + 1) / (2 * clip.BLOCK)


class Properties(unittest.TestCase):
    def setUp(self):
        self.stabilizer = Gst.ElementFactory.make('l1l2stab')

    def test_values_are_kept_and_enumerations_accept_their_names(self):
        for name, value in ('lambda', 2.0), ('crop-ratio', 0.75), ('window', 40), ('overlap', 12), ('threads', 1):
            self.stabilizer.set_property(name, value)
            self.assertEqual(self.stabilizer.get_property(name), value)
        for name, nick in ('join', 'blend'), ('interpolation', 'lanczos'), ('output-size', 'crop'):
            self.stabilizer.set_property(name, nick)
            self.assertEqual(self.stabilizer.get_property(name).value_nick, nick)

    def test_a_value_out_of_range_is_refused(self):
        # GLib says CRITICAL in 2.84, where it said WARNING before, and here criticals are fatal.
        fatal = GLib.log_set_always_fatal(GLib.LogLevelFlags.LEVEL_ERROR)
        self.addCleanup(GLib.log_set_always_fatal, fatal)
        for name, value in ('crop-ratio', 1.5), ('window', 3), ('lambda', -1.0):
            before = self.stabilizer.get_property(name)
            with self.assertWarns(Warning):
                self.stabilizer.set_property(name, value)
            spec = self.stabilizer.find_property(name)
            self.assertIn(self.stabilizer.get_property(name), (before, spec.minimum, spec.maximum))


class Playing(unittest.TestCase):
    def open(self, settings):
        self.pipeline = Gst.parse_launch(
            f'filesrc location={film} ! decodebin ! l1l2stab name=stabilizer {settings} ! videoconvert ! '
            'video/x-raw,format=GRAY8 ! appsink name=sink sync=false max-buffers=4')
        self.addCleanup(self.pipeline.set_state, Gst.State.NULL)
        self.stabilizer = self.pipeline.get_by_name('stabilizer')

    def samples(self):
        self.pipeline.set_state(Gst.State.PLAYING)
        sink = self.pipeline.get_by_name('sink')
        while (sample := sink.emit('try-pull-sample', 15 * Gst.SECOND)) is not None:
            yield sample

    def check_numbers(self, samples):
        self.assertEqual([clip.frame_of(sample, zoom=1.2).number for sample in samples], [*range(FRAMES)])

    def test_a_controller_zooms_by_stream_time_despite_the_delay(self):
        """The crop ratio is 0.9 for two seconds, goes to 0.75 within the next two, and stays there."""
        self.open('window=30')
        source = GstController.InterpolationControlSource()
        source.set_property('mode', GstController.InterpolationMode.LINEAR)
        for seconds, crop in (0, 0.9), (2, 0.9), (4, 0.75), (9, 0.75):
            source.set(seconds * Gst.SECOND, crop)
        self.assertTrue(self.stabilizer.add_control_binding(
            GstController.DirectControlBinding.new_absolute(self.stabilizer, 'crop-ratio', source)))

        samples = list(self.samples())
        self.check_numbers(samples)
        self.assertAlmostEqual(self.stabilizer.get_property('crop-ratio'), 0.75)
        for sample in samples[144:]:  # 1001xxxx
            self.assertAlmostEqual(magnification(sample), 1 / 0.75, delta=0.06)
        self.open('window=30 crop-ratio=0.9')
        for sample in list(self.samples())[144:]:
            self.assertAlmostEqual(magnification(sample), 1 / 0.9, delta=0.06)

    def test_a_property_set_during_playback_loses_no_frame(self):
        self.open('window=20')
        samples = []
        for i, sample in enumerate(self.samples()):
            samples.append(sample)
            self.stabilizer.set_property('lambda', 0.1 + i % 7)
            self.stabilizer.set_property('crop-ratio', 0.75 + i % 15 / 100)
        self.check_numbers(samples)

    def test_the_latency_is_posted_as_a_message_and_answers_a_query(self):
        self.open('window=45')
        samples = self.samples()
        next(samples)
        bus = self.pipeline.get_bus()
        sources = set()
        while (message := bus.pop_filtered(Gst.MessageType.LATENCY)) is not None:
            sources.add(message.src)
        self.assertIn(self.stabilizer, sources)
        query = Gst.Query.new_latency()
        self.assertTrue(self.stabilizer.get_static_pad('src').query(query))
        self.assertEqual(query.parse_latency()[1], 45 * Gst.SECOND // FPS)


if __name__ == '__main__':
    unittest.main(verbosity=2)
