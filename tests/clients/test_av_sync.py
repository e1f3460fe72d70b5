#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Audio and video stay in sync: flash and beep, which coincide in the input, are found in the output files.

The pipeline is the documented one: the queue of the audio branch holds as much as the window.
"""
import unittest

import clip
from clip import FPS, FRAME, Gst

clip.begin(elements=('avenc_aac', 'matroskamux'))
folder = clip.folder()
SECONDS = 4
film = clip.make(folder / 'film.mov', SECONDS * FPS, audio=True)
# A sixth of a beep's amplitude: the beginning is then found within the first quarter of its period.
THRESHOLD = 2000


def flashes(path):
    """Times of the first frame of each flash, and of all frames, nanoseconds."""
    frames = clip.frames_of(path)
    lit = [f.luma > clip.LIGHT for f in frames]
    return [f.time for f, now, before in zip(frames, lit, [False, *lit]) if now and not before], frames


def beeps(path):
    """The times when a beep begins, nanoseconds."""
    start, samples = clip.samples_of(path)
    onsets, quiet = [], clip.RATE
    for i, sample in enumerate(samples):
        if abs(sample) <= THRESHOLD:
            quiet += 1
            continue
        if quiet > clip.RATE // 2:
            onsets.append(start + i * Gst.SECOND // clip.RATE)
        quiet = 0
    return onsets


class Sync(unittest.TestCase):
    def check(self, path, tolerance):
        """The flash and the beep of each second coincide, and are at their time in the input."""
        lights, frames = flashes(path)
        sounds = beeps(path)
        self.assertEqual([f.number for f in frames], [*range(SECONDS * FPS)])
        self.assertEqual((len(lights), len(sounds)), (SECONDS - 1, SECONDS - 1))
        for second, (light, sound) in enumerate(zip(lights, sounds), 1):
            print(f'{path.name}: flash at {light / 1e6:.1f} ms, beep {(sound - light) / 1e6:+.1f} ms')
            self.assertAlmostEqual(light / FRAME, second * FPS, delta=0.05)
            self.assertLess(abs(sound - light), tolerance)

    def stabilize(self, name, settings, audio, muxer):
        out = folder / name
        clip.play(f'filesrc location={film} ! decodebin name=in {muxer} name=out ! filesink location={out} '
                  f'in. ! queue ! l1l2stab {settings} ! x264enc speed-preset=superfast ! h264parse ! queue ! out. '
                  'in. ! queue max-size-time=0 max-size-bytes=0 max-size-buffers=0 ! audioconvert ! '
                  f'{audio} ! out.')
        return out

    def test_the_clip_itself_is_in_sync(self):
        self.check(film, 0.1 * FRAME)

    def test_an_mp4_file_is_in_sync_within_a_frame(self):
        self.check(self.stabilize('out.mp4', 'window=40', 'avenc_aac', 'mp4mux'), FRAME)

    def test_with_a_window_longer_than_the_clip_an_mp4_file_is_in_sync_within_a_frame(self):
        self.check(self.stabilize('long.mp4', 'window=150', 'avenc_aac', 'mp4mux'), FRAME)

    def test_a_matroska_file_is_in_sync_within_a_frame(self):
        self.check(self.stabilize('out.mkv', '', 'flacenc', 'matroskamux'), FRAME)


if __name__ == '__main__':
    unittest.main(verbosity=2)
