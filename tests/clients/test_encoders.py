#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""decodebin ! l1l2stab ! encoder ! muxer: no frame is lost, repeated or shifted. Encoders not installed are skipped."""
import unittest

import clip
from clip import FRAME, Gst

FRAMES = 24
# Where a picture cannot be put into MP4 or WebM, it goes into Matroska.
CHAINS = {
    'x264enc': 'x264enc ! h264parse ! mp4mux',
    'x264enc in 4:4:4': 'videoconvert ! video/x-raw,format=Y444 ! l1l2stab ! x264enc ! h264parse ! mp4mux',
    'x265enc': 'x265enc speed-preset=ultrafast ! h265parse ! mp4mux',
    'vp8enc': 'vp8enc deadline=1 cpu-used=8 ! webmmux',
    'vp9enc': 'vp9enc deadline=1 cpu-used=8 ! webmmux',
    'av1enc': 'av1enc usage-profile=realtime cpu-used=8 ! av1parse ! matroskamux',
    'theoraenc': 'theoraenc ! oggmux',
    'jpegenc': 'jpegenc ! qtmux',
    'avenc_ffv1': 'avenc_ffv1 ! matroskamux',
    'avenc_mjpeg': 'avenc_mjpeg bitrate=8000000 ! avimux',
    'avenc_prores_ks': 'videoconvert ! avenc_prores_ks ! qtmux',
}

clip.begin()
folder = clip.folder()
film = clip.make(folder / 'film.mov', FRAMES)


class Encoders(unittest.TestCase):
    def encode(self, chain):
        stabilizer = '' if 'l1l2stab' in chain else 'l1l2stab window=10 !'
        out = folder / 'out'
        clip.play(f'filesrc location={film} ! decodebin ! {stabilizer} {chain} ! filesink location={out}')
        return clip.frames_of(out)


def add_test(name, chain):
    factories = [word.split()[0] for word in chain.split('!') if '/' not in word.split()[0]]
    missing = [f for f in factories if f != 'l1l2stab' and not Gst.ElementFactory.find(f)]

    @unittest.skipIf(missing, f'not installed: {missing}')
    def every_frame_is_encoded_once_at_its_time(self):
        frames = self.encode(chain)
        self.assertEqual([f.number for f in frames], [*range(FRAMES)])
        for i, frame in enumerate(frames):
            self.assertAlmostEqual(frame.time / FRAME, i, delta=0.05)

    words = ''.join(c if c.isalnum() else '_' for c in name)
    setattr(Encoders, f'test_{words}_has_every_frame_once_at_its_time', every_frame_is_encoded_once_at_its_time)


for name, chain in CHAINS.items():
    add_test(name, chain)

if __name__ == '__main__':
    unittest.main(verbosity=2)
