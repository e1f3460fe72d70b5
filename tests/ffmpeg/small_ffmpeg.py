# SPDX-License-Identifier: MIT
"""Runs the small ffmpeg that build-ffmpeg.sh makes. A test program's first argument is the build folder of the library,
the second, if there is one, the version of FFmpeg."""
import os
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / 'clients'))

SKIPPED = 77
BUILD = Path(sys.argv.pop(1)).resolve()
VERSION = sys.argv.pop(1) if len(sys.argv) > 1 and sys.argv[1][0].isdigit() else '5.1'


class Frame(NamedTuple):
    pts: int
    bytes: int
    md5: str


def build(version=VERSION, flavor='lgpl'):
    """The folder of the small ffmpeg. Without its source the test ends as skipped."""
    made = subprocess.run([HERE / 'build-ffmpeg.sh', BUILD, version, flavor], stdout=subprocess.PIPE, text=True,
                          check=False)
    if made.returncode != 0:
        sys.exit(made.returncode)
    return Path(made.stdout.strip())


FOLDER = build()
ENVIRONMENT = {**os.environ, 'LD_LIBRARY_PATH': f'{FOLDER / "lib"}:{BUILD / "lib"}', 'AV_LOG_FORCE_NOCOLOR': '1'}


def command(*words, program='ffmpeg'):
    banner = [] if program == 'ffprobe' else ['-nostdin']
    return [str(FOLDER / 'bin' / program), '-hide_banner', *banner, *map(str, words)]


def run(*words, program='ffmpeg', feed=b'', fails=False, wrapper=(), seconds=120):
    """Runs it to its end, and returns (output, messages). Raises an error unless it ends as expected."""
    result = subprocess.run([*wrapper, *command(*words, program=program)], input=feed, capture_output=True,
                            timeout=seconds, env=ENVIRONMENT, check=False)
    messages = result.stderr.decode(errors='replace')
    if (result.returncode != 0) != fails:
        raise RuntimeError(f'{program} {" ".join(map(str, words))}: exit code {result.returncode}\n{messages}')
    return result.stdout, messages


def frames_of(*words, **options):
    """The video frames that an ffmpeg command makes, by their timestamps and MD5."""
    table = run('-v', 'error', *words, '-an', '-f', 'framemd5', '-', **options)[0].decode()
    rows = [[field.strip() for field in line.split(',')] for line in table.splitlines() if line[0] != '#']
    return [Frame(int(row[2]), int(row[4]), row[5]) for row in rows]


def raw(path, width, height, pixel_format='yuv420p', rate=30):
    """The words that open a file of raw frames."""
    return ['-f', 'rawvideo', '-video_size', f'{width}x{height}', '-framerate', rate, '-pixel_format', pixel_format,
            '-i', path]
