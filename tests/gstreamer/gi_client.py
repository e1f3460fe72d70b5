#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An application in Python: properties, controller, messages, statistics, metas and motion files, in real pipelines.

Exits with status 77 (skipped) if the bindings are not installed.
"""
import locale
import os
import subprocess
import sys
import tempfile
import unittest
import warnings

try:
    import gi
    gi.require_version('Gst', '1.0')
    gi.require_version('GstController', '1.0')
    from gi.repository import Gst, GstController
except (ImportError, ValueError) as missing:
    print(f'skipped: {missing}: the packages python3-gi and gir1.2-gstreamer-1.0 are needed')
    sys.exit(77)

FRAMES = 40
SOURCE = f'videotestsrc num-buffers={FRAMES} pattern=smpte horizontal-speed=3 ! video/x-raw,format=I420,width=320,' \
         'height=240,framerate=25/1'
FRAME_NS = Gst.SECOND // 25


def matrix(structure, field):
    """The nine doubles of a field, read by the function that is made for bindings."""
    found, array = structure.get_array(field)
    assert found, field
    return [array.get_nth(i) for i in range(array.n_values)]


def apply(m, x, y):
    w = m[6] * x + m[7] * y + m[8]
    return (m[0] * x + m[1] * y + m[2]) / w, (m[3] * x + m[4] * y + m[5]) / w


class Run:
    """Plays a pipeline to its end. Keeps the messages of the element, and see(buffer) of each output buffer."""

    def __init__(self, stab, see=None, after='fakesink name=sink signal-handoffs=true', prepare=None):
        self.pipeline = Gst.parse_launch(f'{SOURCE} ! l1l2stab name=stab window=8 {stab} ! {after}')
        self.stab = self.pipeline.get_by_name('stab')
        self.messages, self.seen, self.error = [], [], None
        if see:
            sink = self.pipeline.get_by_name('sink')
            sink.connect('handoff', lambda sink, buffer, pad: self.seen.append(see(buffer)))
        if prepare:
            prepare(self.stab)
        self.play()
        self.stats = self.stab.get_property('stats')
        self.pipeline.set_state(Gst.State.NULL)

    def play(self):
        bus = self.pipeline.get_bus()
        self.pipeline.set_state(Gst.State.PLAYING)
        while True:
            message = bus.timed_pop_filtered(
                30 * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR | Gst.MessageType.ELEMENT)
            assert message, 'the pipeline hangs'
            if message.type == Gst.MessageType.ELEMENT:
                if message.src == self.stab:
                    self.messages.append(message.get_structure())
                continue
            if message.type == Gst.MessageType.ERROR:
                self.error = message.parse_error()[0]
            return


class Client(unittest.TestCase):
    def test_every_property_has_a_description(self):
        stab = Gst.ElementFactory.make('l1l2stab')
        own = [spec for spec in stab.list_properties() if spec.owner_type == stab.__gtype__]
        self.assertGreaterEqual(len(own), 14)
        for spec in own:
            self.assertTrue(len(spec.blurb) > 20, spec.name)
        self.assertEqual(stab.get_property('join').value_nick, 'continuous')
        stab.set_property('motion-model', 'translation')
        self.assertEqual(stab.get_property('motion-model').value_nick, 'translation')

    def test_a_controller_moves_the_crop_linearly_with_the_stream_time(self):
        def control(stab):
            source = GstController.InterpolationControlSource()
            source.props.mode = GstController.InterpolationMode.LINEAR
            source.set(0, 0.9)
            source.set(FRAMES * FRAME_NS, 0.8)
            binding = GstController.DirectControlBinding.new_absolute(stab, 'crop-ratio', source)
            self.assertTrue(stab.add_control_binding(binding))

        run = Run('post-messages=true', prepare=control)
        self.assertEqual(len(run.messages), FRAMES)
        for index, message in enumerate(run.messages):
            self.assertEqual(message.get_uint64('stream-time').value, index * FRAME_NS)
            self.assertAlmostEqual(message.get_double('crop-ratio').value, 0.9 - 0.1 * index / FRAMES, places=9)

    def test_a_new_lambda_applies_to_the_frames_that_come_in_later(self):
        switched = []

        def on_input(pad, info, stab):
            if info.get_buffer().pts == 20 * FRAME_NS:
                stab.set_property('lambda', 3.0)
                switched.append(True)
            return Gst.PadProbeReturn.OK

        run = Run('post-messages=true', prepare=lambda stab: stab.get_static_pad('sink').add_probe(
            Gst.PadProbeType.BUFFER, on_input, stab))
        self.assertTrue(switched)
        values = [message.get_double('lambda').value for message in run.messages]
        self.assertEqual(values, [0.5] * 20 + [3.0] * (FRAMES - 20))

    def test_a_box_is_mapped_back_even_after_a_converter_and_a_scaler(self):
        def look(buffer):
            meta = buffer.get_custom_meta('GstL1L2StabMeta').get_structure()
            to_source, from_source = matrix(meta, 'to-source'), matrix(meta, 'from-source')
            middle = apply(to_source, meta.get_int('width').value / 2, meta.get_int('height').value / 2)
            corners = [apply(to_source, *corner) for corner in ((0, 0), (160, 0), (0, 480), (160, 480))]
            return middle, corners, apply(from_source, *middle), meta.get_uint64('frame').value

        run = Run('crop-ratio=0.8', look,
                  'queue ! videoconvert ! video/x-raw,format=RGB ! videoscale ! video/x-raw,width=160,height=480 ! '
                  'fakesink name=sink signal-handoffs=true')
        self.assertEqual([seen[3] for seen in run.seen], list(range(FRAMES)))
        for middle, corners, back, _ in run.seen:
            self.assertAlmostEqual(back[0], 80, places=6)
            self.assertAlmostEqual(back[1], 240, places=6)
            self.assertTrue(32 - 1e-6 <= middle[0] <= 288 and abs(middle[1] - 120) <= 24 + 1e-6)
            for x, y in corners: # nothing comes from outside the source
                self.assertTrue(-1e-6 <= x <= 320 + 1e-6 and -1e-6 <= y <= 240 + 1e-6)

    def test_the_statistics_add_up(self):
        stats = Run('').stats
        self.assertEqual(stats.get_name(), 'l1l2stab-stats')
        self.assertEqual(stats.get_uint64('frames-in').value, FRAMES)
        self.assertEqual(stats.get_uint64('frames-out').value, FRAMES)
        self.assertEqual(stats.get_uint64('latency').value, 8 * FRAME_NS)
        self.assertTrue(0 <= stats.get_double('quality-min').value <= stats.get_double('quality-mean').value <= 1)

    def test_messages_can_be_logged_as_text(self):
        text = Run('post-messages=true').messages[5].to_string()
        for field in ('l1l2stab-frame', 'motion=(double)<', 'path=(double)<', 'model=(string)', 'quality=(double)'):
            self.assertIn(field, text)

    def test_a_second_run_from_a_motion_file_gives_the_same_bytes(self):
        with tempfile.TemporaryDirectory() as folder:
            first = Run(f'motion-out={folder}/a', lambda b: b.extract_dup(0, b.get_size()))
            second = Run(f'motion-in={folder}/a', lambda b: b.extract_dup(0, b.get_size()))
        self.assertEqual(len(first.seen), FRAMES)
        self.assertEqual(first.seen, second.seen)
        self.assertEqual(second.stats.get_uint64('track-time').value, 0)

    def test_a_motion_file_for_other_frames_is_an_error_that_says_so(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(f'{folder}/a', 'w', encoding='ascii') as file:
                file.write('l1l2stab-motion 1\nsize 640 480\n')
            error = Run(f'motion-in={folder}/a').error
        self.assertTrue(error.matches(Gst.ResourceError.quark(), Gst.ResourceError.READ))
        self.assertIn('640x480', error.message)

    def test_a_motion_file_is_the_same_in_a_locale_with_a_decimal_comma(self):
        with tempfile.TemporaryDirectory() as folder:
            made = subprocess.run(['localedef', '-i', 'de_DE', '-f', 'UTF-8', f'{folder}/de_DE.UTF-8'],
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
            if made.returncode > 1:
                self.skipTest(f'localedef: {made.stdout}')
            Run(f'motion-out={folder}/point')
            os.environ['LOCPATH'] = folder
            locale.setlocale(locale.LC_ALL, 'de_DE.UTF-8')
            try:
                self.assertEqual(locale.localeconv()['decimal_point'], ',')
                self.assertIsNone(Run(f'motion-in={folder}/point motion-out={folder}/comma').error)
            finally:
                locale.setlocale(locale.LC_ALL, 'C')
            with open(f'{folder}/point', encoding='ascii') as point, open(f'{folder}/comma', encoding='ascii') as comma:
                self.assertEqual(point.read(), comma.read())


if __name__ == '__main__':
    warnings.simplefilter('ignore', DeprecationWarning) # of GLib's arrays, which get_array() gives
    Gst.init(None)
    unittest.main(verbosity=2)
