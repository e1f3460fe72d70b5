#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What goes in and what comes out: each kind of kinds.py is stabilized, and compared with its output by ffprobe.

test_kinds.py L1L2STAB [KIND...]
test_kinds.py L1L2STAB --table      prints the table of docs/command.md
"""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import case
import kinds
import probe
from case import L1L2STAB



def stabilize(kind, folder):
    """Makes an input and runs the command. Returns both files and the finished process."""
    before = folder / f'{kind.name}.{kind.suffix}'
    after = folder / f'{kind.name}-out.{kind.out or kind.suffix}'
    kind.make(before)
    run = subprocess.run([L1L2STAB, *kind.options, str(before), '-o', str(after)], stderr=subprocess.PIPE, timeout=100,
                         encoding='utf-8')
    return before, after, run


def print_table():
    print('| Kind | In | Out | Frames | Lost |\n|---|---|---|---|---|')
    for kind in kinds.KINDS:
        with tempfile.TemporaryDirectory() as folder:
            before, after, run = stabilize(kind, Path(folder))
            was, is_now = probe.File(before), probe.File(after)
            lost = list(probe.compare(was, is_now, kind)) or ['nothing']
            frames = f'{len(was.frames)} -> {len(is_now.frames)}'
            print(f'| {kind.name} | {was.summary()} | {is_now.summary()} | {frames} | {"; ".join(lost)} |', flush=True)


class Kinds(case.OneFolder):
    """One test for each kind, added below."""

    def check(self, kind):
        before, after, run = stabilize(kind, self.path)
        self.assertEqual(run.returncode, kind.exit, run.stderr)
        for note in kind.notes:
            self.assertIn(note, run.stderr)
        was, is_now = probe.File(before), probe.File(after)
        self.assertEqual(list(probe.compare(was, is_now, kind)), [])
        before.unlink()
        after.unlink()


def add(kind):
    def test(self):
        self.check(kind)
    test.__doc__ = f'nothing is lost: {kind.name}'
    setattr(Kinds, 'test_' + kind.name.replace('-', '_'), test)


class Compare(unittest.TestCase):
    """The comparison finds what is lost: a test that cannot fail shows nothing."""

    def lost(self, make_before, make_after, **facts):
        with tempfile.TemporaryDirectory() as folder:
            before, after = Path(folder) / 'before.mp4', Path(folder) / 'after.mp4'
            make_before(before)
            make_after(before, after)
            return ' '.join(probe.compare(probe.File(before), probe.File(after), kinds.Kind('', 'mp4', None, **facts)))

    def test_a_lost_track_chapter_subtitle_and_tag_are_found(self):
        said = self.lost(kinds.rich('mov_text'), lambda before, after: kinds.ffmpeg(
            '-i', before, '-map', '0:v', '-map', '0:a:0', '-map_chapters', '-1', '-map_metadata', '-1', '-c',
            'copy', after),
            tags=('title',))
        for word in ('audio streams', 'subtitle streams', 'chapters', 'tag title', 'language'):
            self.assertIn(word, said)

    def test_a_picture_on_its_side_is_found(self):
        for turn, word in (('transpose=clock', 'shape'), ('hflip,vflip', 'the picture is turned')):
            said = self.lost(kinds.turned(90), lambda before, after, turn=turn: kinds.ffmpeg('-i', before, '-vf',
                                                                                             turn, after))
            self.assertIn(word, said)

    def test_lost_frames_moved_frames_and_moved_sound_are_found(self):
        def shorter(before, after):
            kinds.ffmpeg('-i', before, '-frames:v', '30', *kinds.H264, '-c:a', 'copy', after)
        self.assertIn('frames are now', self.lost(kinds.variable_rate, shorter))

        def even(before, after):
            kinds.ffmpeg('-i', before, '-vf', 'setpts=N/30/TB', *kinds.H264, '-c:a', 'copy', after)
        self.assertIn('is moved', self.lost(kinds.variable_rate, even))

        def late(before, after):
            kinds.ffmpeg('-i', before, '-itsoffset', '0.2', '-i', before, '-map', '0:v', '-map', '1:a', '-c',
                         'copy', after)
        self.assertIn('the sound is off', self.lost(kinds.simple(*kinds.H264, *kinds.AAC), late))

    def test_lost_bits_and_color_are_found(self):
        make = next(kind.make for kind in kinds.KINDS if kind.name == 'mp4-hevc-hdr10')
        said = self.lost(make, lambda before, after: kinds.ffmpeg('-i', before, *kinds.H264, '-color_trc', 'bt709',
                                                                  after))
        for word in ('10 bits', 'color_transfer', 'HDR'):
            self.assertIn(word, said)


if __name__ == '__main__':
    if '--table' in sys.argv:
        print_table()
        sys.exit()
    wanted = set(sys.argv[2:])
    for each in kinds.KINDS:
        if not wanted or each.name in wanted:
            add(each)
    unittest.main(argv=sys.argv[:1])
