#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""An RTSP server with a camera and l1l2stab: two viewers over loopback, of which the second comes later."""
import itertools
import sys
import threading
import unittest

import clip
from clip import FPS, FRAME, Gst

clip.begin(elements=('rtspsrc', 'rtph264pay'))
try:
    import gi
    gi.require_version('GstRtspServer', '1.0')
    from gi.repository import GLib, GstRtspServer
except (ImportError, ValueError) as reason:
    print('skipped:', reason)
    sys.exit(clip.SKIPPED)

WINDOW = 15
SERVED = (
    f'( appsrc name=camera is-live=true do-timestamp=true format=time caps=video/x-raw,format=I420,width={clip.WIDTH},'
    f'height={clip.HEIGHT},framerate={FPS}/1 ! l1l2stab name=stabilizer window={WINDOW} ! '
    'x264enc tune=zerolatency speed-preset=superfast pass=qual quantizer=18 key-int-max=10 ! rtph264pay name=pay0 )')


class Camera:
    """Serves the clip endlessly, in real time, in a thread of its own."""

    def __init__(self):
        self.loop = GLib.MainLoop()
        self.server = GstRtspServer.RTSPServer()
        self.server.set_address('127.0.0.1')
        self.server.set_service('0')
        factory = GstRtspServer.RTSPMediaFactory()
        factory.set_launch(SERVED)
        factory.set_shared(True)
        factory.connect('media-configure', self.start_film)
        self.server.get_mount_points().add_factory('/steady', factory)
        self.film = itertools.cycle(list(clip.pictures(FPS)))
        self.media = []
        self.attached = self.server.attach(None)
        threading.Thread(target=self.loop.run, daemon=True).start()

    def start_film(self, factory, media):
        self.media.append(media)
        source = media.get_element().get_by_name('camera')
        GLib.timeout_add(1000 // FPS, self.push, source)

    def push(self, source):
        return source.emit('push-buffer', Gst.Buffer.new_wrapped(next(self.film))) == Gst.FlowReturn.OK

    def address(self):
        return f'rtsp://127.0.0.1:{self.server.get_bound_port()}/steady'

    def latency(self):
        query = Gst.Query.new_latency()
        self.media[0].get_element().get_by_name('pay0').get_static_pad('src').query(query)
        return query.parse_latency()


class Viewer:
    def __init__(self, address):
        self.pipeline = Gst.parse_launch(
            f'rtspsrc location={address} protocols=tcp latency=200 ! rtph264depay wait-for-keyframe=true ! '
            'avdec_h264 ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=sink sync=true max-lateness=500000000')
        self.sink = self.pipeline.get_by_name('sink')
        self.pipeline.set_state(Gst.State.PLAYING)

    def frames(self, count):
        samples = [self.sink.emit('try-pull-sample', 15 * Gst.SECOND) for _ in range(count)]
        return [clip.frame_of(sample) for sample in samples if sample]

    def dropped(self):
        return self.sink.get_property('stats').get_value('dropped')

    def close(self):
        self.pipeline.set_state(Gst.State.NULL)


class Rtsp(unittest.TestCase):
    def check(self, frames, count):
        """Every frame of the camera, each once."""
        self.assertEqual(len(frames), count)
        for a, b in zip(frames, frames[1:]):
            self.assertEqual(b.number, (a.number + 1) % FPS)
            self.assertGreater(b.time, a.time)

    def test_two_viewers_get_every_frame_in_time(self):
        camera = Camera()
        first = Viewer(camera.address())
        self.check(first.frames(20), 20)
        second = Viewer(camera.address())
        self.check(second.frames(30), 30)
        self.check(first.frames(30), 30)
        self.assertEqual((first.dropped(), second.dropped()), (0, 0))
        self.assertEqual(len(camera.media), 1, 'the viewers share one stabilizer')

        live, least, _ = camera.latency()
        print(f'latency of the server: {least / 1e6:.0f} ms, {WINDOW} frames are {WINDOW * FRAME / 1e6:.0f} ms')
        self.assertTrue(live)
        self.assertGreaterEqual(least, WINDOW * Gst.SECOND // FPS)

        first.close()
        self.check(second.frames(10), 10)
        second.close()


if __name__ == '__main__':
    unittest.main(verbosity=2)
