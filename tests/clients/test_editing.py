#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""GStreamer Editing Services: l1l2stab as the effect of a clip, in ges-launch-1.0 and in an editor's preview."""
import itertools
import unittest

import clip
from clip import FPS, FRAME, Gst

clip.begin('ges-launch-1.0')
folder = clip.folder()
film = clip.make(folder / 'film.mov')
VIDEO_CAPS = f'video/x-raw,width={clip.WIDTH},height={clip.HEIGHT},framerate={FPS}/1'


def render(*timeline):
    """The frames that ges-launch-1.0 renders from a timeline."""
    out = folder / 'out.mov'
    clip.run('ges-launch-1.0', '--no-interactive', *timeline, '--track-types', 'video', '--video-caps', VIDEO_CAPS,
             '-o', out, '--format', 'video/quicktime,variant=iso:video/x-h264')
    return clip.frames_of(out)


class Rendering(unittest.TestCase):
    def test_trimmed_clips_give_exactly_their_frames_in_order(self):
        frames = render('+clip', film, 'inpoint=1.0', 'duration=1.0', '+effect', 'l1l2stab window=10',
                        '+clip', film, 'inpoint=0.5', 'duration=0.5', '+effect', 'l1l2stab window=40')
        self.assertEqual([f.number for f in frames], [*range(30, 60), *range(15, 30)])
        for i, frame in enumerate(frames):
            self.assertAlmostEqual(frame.time / FRAME, i, delta=0.01)

    def test_the_effect_stabilizes_its_own_clip_and_no_other(self):
        frames = render('+clip', film, 'duration=1.0', '+clip', film, 'duration=1.0', '+effect', 'l1l2stab')
        self.assertEqual([f.number for f in frames], [*range(30)] * 2)
        self.assertLess(clip.unrest(frames[30:]), 0.2 * clip.unrest(frames[:30]))

    def test_a_property_can_be_set_on_the_command_line(self):
        half = render('+clip', film, 'duration=0.5', '+effect', 'l1l2stab', 'set-crop-ratio', '0.5')
        most = render('+clip', film, 'duration=0.5', '+effect', 'l1l2stab', 'set-crop-ratio', '0.9')
        self.assertEqual((len(half), len(most)), (15, 15))
        self.assertNotEqual(half[0].edge, most[0].edge)


class Preview(unittest.TestCase):
    """The viewer of an editor: two clips, at 0 s and at 1 s, each with its own stabilizer."""

    def setUp(self):
        try:
            import gi
            gi.require_version('GES', '1.0')
            from gi.repository import GES
        except (ImportError, ValueError) as reason:
            self.skipTest(str(reason))
        GES.init()
        self.timeline = GES.Timeline.new()
        track = GES.VideoTrack.new()
        track.set_restriction_caps(Gst.Caps.from_string(VIDEO_CAPS))
        self.timeline.add_track(track)
        asset = GES.UriClipAsset.request_sync(film.as_uri())
        layer = self.timeline.append_layer()
        self.clips = []
        for start, inpoint, window in (0, 1.0, 10), (1, 0.5, 40):
            self.clips.append(layer.add_asset(asset, start * Gst.SECOND, int(inpoint * Gst.SECOND), Gst.SECOND,
                                              GES.TrackType.VIDEO))
            self.clips[-1].add(GES.Effect.new(f'l1l2stab window={window}'))
        self.timeline.commit_sync()

        self.pipeline = GES.Pipeline()
        self.pipeline.set_timeline(self.timeline)
        viewer = Gst.parse_bin_from_description(
            'videoconvert ! video/x-raw,format=GRAY8 ! appsink name=sink sync=false max-buffers=4', True)
        self.sink = viewer.get_by_name('sink')
        self.pipeline.preview_set_video_sink(viewer)
        self.pipeline.set_mode(GES.PipelineFlags.VIDEO_PREVIEW)
        self.pipeline.set_state(Gst.State.PLAYING)
        self.settle()

    def tearDown(self):
        self.pipeline.set_state(Gst.State.NULL)

    def settle(self):
        message = self.pipeline.get_bus().timed_pop_filtered(
            10 * Gst.SECOND, Gst.MessageType.ASYNC_DONE | Gst.MessageType.ERROR)
        self.assertEqual(message and message.type, Gst.MessageType.ASYNC_DONE)
        # ASYNC_DONE comes before the change to PLAYING is over. A seek in between is lost, with any effect.
        self.assertEqual(self.pipeline.get_state(10 * Gst.SECOND).state, Gst.State.PLAYING)

    def frames(self):
        while (sample := self.sink.emit('try-pull-sample', 10 * Gst.SECOND)) is not None:
            # appsink of GStreamer 1.22 writes into a sample that its user still holds at the next flushing seek.
            frame, sample = clip.frame_of(sample), None
            yield frame

    def numbers_from(self, first, count):
        """Seeks to a frame of the timeline. Returns the numbers of the next frames. A few old frames can come first."""
        # Rounded up: a time before the frame's own belongs to the frame before it.
        self.assertTrue(self.pipeline.seek_simple(Gst.Format.TIME, Gst.SeekFlags.FLUSH | Gst.SeekFlags.ACCURATE,
                                                  -(-first * Gst.SECOND // FPS)))
        self.settle()
        late = itertools.islice(self.frames(), 30)
        frames = itertools.chain(itertools.dropwhile(lambda f: round(f.time / FRAME) != first, late), self.frames())
        return [frame.number for frame in itertools.islice(frames, count)]

    def test_each_seek_shows_the_frames_from_its_target_on_even_across_the_cut(self):
        for frame, expected in ((15, [45, 46, 47]), (36, [21, 22, 23]), (0, [30, 31, 32]), (28, [58, 59, 15, 16]),
                                (59, [44])):
            self.assertEqual(self.numbers_from(frame, len(expected)), expected)

    def test_a_clip_that_is_trimmed_during_playback_continues_with_its_new_frames(self):
        self.assertEqual(self.numbers_from(0, 3), [30, 31, 32])
        self.clips[1].set_inpoint(0)
        self.clips[1].set_duration(Gst.SECOND // 2)
        self.timeline.commit_sync()
        self.settle()
        self.assertEqual(self.numbers_from(28, 17), [58, 59, *range(15)])


if __name__ == '__main__':
    unittest.main(verbosity=2)
