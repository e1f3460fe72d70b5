#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Every launch line of the documentation does what the documentation says: test_documented_lines.py TOP

The input files of the lines are created, and their output files are checked. A test source replaces each camera and
microphone, and a test sink replaces each screen.
"""
import re
import sys
import threading
import unittest
from pathlib import Path

import clip
from clip import FPS, FRAME

clip.begin('gst-launch-1.0', 'ges-launch-1.0', 'gst-inspect-1.0', elements=(
    'avenc_aac', 'compositor', 'deinterlace', 'fakevideosink', 'rtspsrc', 'x265enc'))
try:
    import gi
    gi.require_version('GstRtspServer', '1.0')
    from gi.repository import GLib, GstRtspServer
except (ImportError, ValueError) as reason:
    print('skipped:', reason)
    sys.exit(clip.SKIPPED)

TOP = Path(sys.argv.pop(1))
PLACES = ['README.md', 'docs/element.md', 'docs/control.md', 'docs/motion-file.md', 'plugin/gstreamer/plugin.c']
FRAMES = 50
LIVE_FRAMES = 45
folder = clip.folder()
film = clip.make(folder / 'in.mp4', FRAMES, audio=True)
clip.play(f'filesrc location={film} ! decodebin ! videoconvert ! video/x-raw,format=I420_10LE ! '
          f'x265enc speed-preset=ultrafast ! h265parse ! mp4mux ! filesink location={folder}/in-10bit.mp4')
(folder / 'mask.pgm').write_bytes(b'P5 2 2 255\n\xff\xff\xff\x00')


def serve_film():
    """Serves the clip like an RTSP camera, and returns its address."""
    server = GstRtspServer.RTSPServer()
    server.set_address('127.0.0.1')
    server.set_service('0')
    factory = GstRtspServer.RTSPMediaFactory()
    factory.set_launch(f'( filesrc location={film} ! qtdemux ! h264parse ! rtph264pay name=pay0 )')
    server.get_mount_points().add_factory('/stream', factory)
    server.attach(None)
    threading.Thread(target=GLib.MainLoop().run, daemon=True).start()
    return f'rtsp://127.0.0.1:{server.get_bound_port()}/stream'


STAND_INS = {
    'v4l2src': f'videotestsrc is-live=true num-buffers={LIVE_FRAMES} ! video/x-raw,width=320,height=240',
    'pulsesrc': 'audiotestsrc is-live=true num-buffers=65',
    'autovideosink': 'identity eos-after=15 ! fakevideosink',
    'rtspsrc': 'rtspsrc protocols=tcp', # no packet gets lost; the server does not signal the end
    'rtsp://camera/stream': serve_film(),
}


def launch_lines(path):
    """The launch lines of a text. Lines that a backslash continues are joined."""
    text = re.sub(r' *\\\n[ *]*', ' ', path.read_text(encoding='utf-8'))
    return re.findall(r'^(?:    | \* )((?:gst|ges)-launch-1\.0 .*)$', text, re.MULTILINE)


def frames_of_ges(path):
    """The frames of a file of ges-launch-1.0, which enlarges all frames to 1280x720, with borders."""
    return clip.frames_of(f'filesrc location={path} ! decodebin ! videoconvert ! videocrop left=160 right=160 ! '
                          f'videoscale ! video/x-raw,width={clip.WIDTH},height={clip.HEIGHT}')


def numbers_side_by_side(path):
    """The numbers in the left half and in the right half of each frame."""
    halves = []
    for x in 0, clip.WIDTH:
        frames = clip.frames_of(f'filesrc location={path} ! decodebin ! videoconvert ! '
                                f'videocrop left={x} right={clip.WIDTH - x}')
        halves.append([frame.number for frame in frames])
    return halves


class Documented(unittest.TestCase):
    def check_file(self, line, out):
        if 'compositor' in line:
            self.assertEqual(numbers_side_by_side(out), [[*range(FRAMES)]] * 2)
            return
        frames = frames_of_ges(out) if line.startswith('ges') else clip.frames_of(out)
        if 'v4l2src' in line:
            self.assertEqual(len(frames), LIVE_FRAMES)
        else:
            self.assertEqual([f.number for f in frames],
                             [*range(15, 45)] if line.startswith('ges') else [*range(FRAMES)])
            for i, frame in enumerate(frames):
                self.assertAlmostEqual(frame.time / FRAME, i, delta=0.05)
        if 'avenc_aac' in line:
            self.assertGreater(len(clip.samples_of(out)[1]), len(frames) * clip.RATE // FPS)
        if '10bit' in line:
            found = clip.run('gst-discoverer-1.0', '-v', out)
            self.assertIn('bit-depth-luma=(uint)10', found)

    def check_line(self, line):
        command = line
        for real, stand_in in STAND_INS.items():
            command = command.replace(real, stand_in)
        out = folder / 'out.mp4'
        out.unlink(missing_ok=True)
        said = clip.run('bash', '-c', f'cd {folder} && {command}')
        self.assertNotRegex(said, r'WARN|Impossible|missing')
        if out.name in line:
            self.check_file(line, out)


    @unittest.skipUnless((TOP / 'docs/element.md').exists(), 'no docs/element.md')
    def test_the_table_of_properties_has_every_property(self):
        page = (TOP / 'docs/element.md').read_text(encoding='utf-8')
        section = re.search(r'^## Properties\n(.*?)^## ', page, re.MULTILINE | re.DOTALL)[1]
        table = re.findall(r'^\| (`[^|]*`) \|', section, re.MULTILINE)
        listed = {name for names in table for name in re.findall(r'`([a-z-]+)`', names)}
        said = clip.run('gst-inspect-1.0', 'l1l2stab')
        properties = set(re.findall(r'^  ([a-z-]+) +: ', said[said.index('Element Properties'):], re.MULTILINE))
        self.assertIn('region', properties)
        self.assertEqual(properties - {'name', 'parent', 'qos'}, listed)


def add_tests(place):
    for i, line in enumerate(launch_lines(TOP / place), 1):
        name = re.sub(r'\W', '_', place)
        setattr(Documented, f'test_line_{i}_of_{name}_does_what_is_said', lambda self, line=line: self.check_line(line))


for place in PLACES:
    if (TOP / place).exists():
        add_tests(place)

if __name__ == '__main__':
    unittest.main(verbosity=2)
