#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""MLT's melt with the libavfilter that has the filter. MLT takes one frame out of it for each that it puts in, so the
film comes out late, after untouched frames, and its end is lost."""
import os
import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import small_ffmpeg
import clip

FRAMES, WINDOW = 60, 12
LATE = WINDOW - 1


def skip(reason):
    print('skipped:', reason)
    sys.exit(small_ffmpeg.SKIPPED)


def environment(folder):
    """An environment in which melt finds this libavfilter, and its other libraries as always."""
    module = next(Path('/usr/lib').glob('**/mlt-7/libmltavformat.so'), None)
    if not shutil.which('melt') or not module:
        skip('melt is not installed')
    wanted = re.search(r'libavfilter\.so\.\d+', subprocess.run(['ldd', module], stdout=subprocess.PIPE, text=True,
                                                              check=True).stdout)
    library = small_ffmpeg.FOLDER / 'lib' / (wanted[0] if wanted else 'libavfilter.so')
    if not wanted or not library.exists():
        skip(f'melt is linked to another libavfilter than that of FFmpeg {small_ffmpeg.VERSION}')
    (folder / library.name).symlink_to(library)
    return {**os.environ, 'LD_LIBRARY_PATH': f'{folder}:{small_ffmpeg.BUILD / "lib"}', 'QT_QPA_PLATFORM': 'offscreen'}


clip.begin()
folder = clip.folder()
melt = environment(folder)
movie = clip.make(folder / 'film.mov', FRAMES)


def by_melt(*words):
    out = folder / 'out.mkv'
    subprocess.run(['melt', movie, *words, '-consumer', f'avformat:{out}', 'vcodec=ffv1', 'an=1', 'real_time=-1',
                    'terminate_on_pause=1'], env=melt, capture_output=True, check=True, timeout=90)
    return clip.frames_of(out)


class Melt(unittest.TestCase):
    def test_melt_lists_the_filter_with_its_options(self):
        told = subprocess.run(['melt', '-query', 'filter=avfilter.l1l2stab'], env=melt, capture_output=True, text=True,
                              check=True, timeout=60)
        self.assertIn('identifier: av.crop_ratio', told.stdout + told.stderr)

    def test_melt_stabilizes_a_film_but_shows_it_late_by_the_window(self):
        plain = by_melt()
        steady = by_melt('-filter', 'avfilter.l1l2stab', f'av.window={WINDOW}')
        self.assertEqual([f.number for f in plain], [*range(FRAMES)])
        self.assertEqual([f.number for f in steady], [*range(LATE), *range(FRAMES - LATE)])
        self.assertLess(clip.unrest(steady[LATE:]), 0.7 * clip.unrest(plain[:FRAMES - LATE]))


if __name__ == '__main__':
    unittest.main(verbosity=2)
