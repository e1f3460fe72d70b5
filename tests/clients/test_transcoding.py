#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""uritranscodebin with l1l2stab as its video filter: a file is transcoded with its audio."""
import unittest

import clip
from clip import FPS, FRAME

clip.begin('gst-launch-1.0', elements=('uritranscodebin', 'vp8enc', 'webmmux', 'opusenc', 'avenc_aac'))
folder = clip.folder()
FRAMES = 2 * FPS
film = clip.make(folder / 'film.mov', FRAMES, audio=True)


class Transcoding(unittest.TestCase):
    def check(self, stabilizer, profile):
        out = folder / 'out'
        # GStreamer 1.22 has a fault here: with any filter it unrefs a NULL object. So criticals are not fatal.
        clip.run('gst-launch-1.0', '-q', 'uritranscodebin', f'source-uri={film.as_uri()}', f'dest-uri={out.as_uri()}',
                 f'profile={profile}', f'video-filter={stabilizer}', G_DEBUG='')
        frames = clip.frames_of(out)
        self.assertEqual([f.number for f in frames], [*range(FRAMES)])
        for i, frame in enumerate(frames):
            self.assertAlmostEqual(frame.time / FRAME, i, delta=0.05)
        self.assertLess(clip.unrest(frames), 0.2 * clip.unrest(clip.frames_of(film)))
        start, samples = clip.samples_of(out)
        self.assertAlmostEqual((start / 1e9 + len(samples) / clip.RATE), FRAMES / FPS, delta=0.1)

    def test_an_mp4_file_has_every_frame_and_the_audio(self):
        self.check('l1l2stab', 'video/quicktime,variant=iso:video/x-h264:audio/mpeg,mpegversion=4')

    def test_a_webm_file_has_every_frame_and_the_audio(self):
        self.check('l1l2stab', 'video/webm:video/x-vp8:audio/x-opus')


if __name__ == '__main__':
    unittest.main(verbosity=2)
