#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Random damage to video files: cut, bits flipped, bytes removed, added or zeroed, boxes of MP4 removed or resized.

test_damage.py L1L2STAB COUNT [SEED]

The command ends by itself within a minute with one of its exit codes. What it wrote is a whole video or nothing, and
the input is as it was. A failure prints the number of the file; the damage depends on number and seed alone.
"""
import hashlib
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import kinds

L1L2STAB = os.path.abspath(sys.argv[1])
COUNT = int(sys.argv[2])
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 1

SECONDS = 60
FOUND = (76, 166, 829)  # files that once were refused or lost; other versions of the encoders make others of them
EXIT_CODES = (0, 3, 5, 6)  # done, no usable video, a codec that nobody has, damaged but done: see the manual page
OPTIONS = ('--window=6', '--interpolation=bilinear')


def make_stock(folder):
    """One small file for each container."""
    small = kinds.video(96, 64, 25, 0.6)
    sound = kinds.tone(440, 0.6)
    for name, codecs in (('whole.mp4', [*kinds.H264, *kinds.AAC]), ('whole.mkv', [*kinds.H264, *kinds.AAC]),
                         ('whole.ts', [*kinds.H264, *kinds.AAC]), ('whole.avi', ['-c:v', 'mpeg4', '-c:a', 'mp3']),
                         ('whole.webm', ['-c:v', 'libvpx', '-deadline', 'realtime', '-c:a', 'libopus']),
                         ('fast.mp4', [*kinds.H264, *kinds.AAC, '-movflags', '+faststart'])):
        kinds.ffmpeg(*small, *sound, *codecs, folder / name)
    return sorted(folder.iterdir())


def boxes(data, start, end):
    """The (position, size) of each box of an MP4 file, also of those within others."""
    while start + 8 <= end:
        size, kind = struct.unpack('>I4s', data[start:start + 8])
        if size < 8 or start + size > end:
            return
        yield start, size
        if kind in (b'moov', b'trak', b'mdia', b'minf', b'stbl', b'edts', b'udta', b'dinf'):
            yield from boxes(data, start + 8, start + size)
        start += size


def cut(data, dice):
    return data[:dice.randrange(len(data))]


def flip_bits(data, dice):
    for _ in range(dice.choice((1, 8, 64, 512))):
        data[dice.randrange(len(data))] ^= 1 << dice.randrange(8)
    return data


def flip_in_header(data, dice):
    for _ in range(dice.choice((1, 4, 16))):
        data[dice.randrange(min(1024, len(data)))] = dice.choice((0, 1, 0x7f, 0x80, 0xff))
    return data


def remove_bytes(data, dice):
    start = dice.randrange(len(data))
    return data[:start] + data[start + dice.choice((1, 188, 1000)):]


def add_bytes(data, dice):
    start = dice.randrange(len(data))
    return data[:start] + dice.randbytes(dice.choice((1, 188, 1000))) + data[start:]


def zero_bytes(data, dice):
    start = dice.randrange(len(data))
    size = min(dice.choice((16, 512, 4096)), len(data) - start)
    data[start:start + size] = bytes(size)
    return data


def damage_box(data, dice):
    """Removes, renames or resizes a box; in files that have none, it flips bits."""
    found = list(boxes(data, 0, len(data)))
    if not found:
        return flip_bits(data, dice)
    start, size = dice.choice(found)
    how = dice.randrange(4)
    if how == 0:
        return data[:start] + data[start + size:]
    if how == 1:
        data[start + 4:start + 8] = b'free'
    elif how == 2:
        data[start:start + 4] = struct.pack('>I', dice.choice((0, 1, 7, size - 1, size + 1, 0x7fffffff, 0xffffffff)))
    else:
        at = start + dice.randrange(8, max(9, size))
        data[at:at + 4] = struct.pack('>I', dice.choice((0, 1, 0x7fffffff, 0x80000000, 0xffffffff)))
    return data


DAMAGES = (cut, flip_bits, flip_in_header, remove_bytes, add_bytes, zero_bytes, damage_box, damage_box)


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def video_fault(path):
    """What FFmpeg says against the container and the picture of a file, or ''. Damaged sound is copied as it is."""
    run = subprocess.run(['ffmpeg', '-nostdin', '-v', 'error', '-i', str(path), '-map', '0:v:0', '-fps_mode',
                          'passthrough', '-f', 'null', '-'],
                         stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=SECONDS)
    said = [line for line in run.stderr.decode(errors='replace').splitlines()
            if not re.match(r'\[(aac|mp3|mp3float|opus|null) |    Last message|$', line)]
    return '; '.join(said) or ('FFmpeg cannot read it' if run.returncode else '')


def fault_of(damaged, out):
    """Runs the command. Returns what it did wrong, or None, and its exit code."""
    before = digest(damaged)
    target = out / ('steady' + damaged.suffix.replace('.avi', '.mkv'))
    try:
        run = subprocess.run([L1L2STAB, *OPTIONS, str(damaged), '-o', str(target)], stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return f'it did not end within {SECONDS} s', None
    text = run.stderr.decode(errors='replace')
    left = os.listdir(out)
    if run.returncode not in EXIT_CODES:
        return f'exit code {run.returncode}: {text}', run.returncode
    if digest(damaged) != before:
        return 'the input was changed', run.returncode
    if left not in ([], [target.name]) or (run.returncode == 0 and not left):
        return f'it left {left}: {text}', run.returncode
    if run.returncode != 0 and not text.strip():
        return 'it failed without a word', run.returncode
    if left and video_fault(target):
        return f'half-written output: {video_fault(target)}', run.returncode
    return None, run.returncode


def main():
    codes, faults = {}, 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / 'stock').mkdir()
        stock = make_stock(folder / 'stock')
        for whole in stock:
            (folder / 'out').mkdir()
            fault, code = fault_of(whole, folder / 'out')
            assert not fault and code == 0, f'{whole.name}, undamaged: {fault}, exit code {code}'
            shutil.rmtree(folder / 'out')
        for number in (*FOUND, *range(COUNT)):
            dice = random.Random(f'{SEED}/{number}')
            whole, damage = stock[number % len(stock)], dice.choice(DAMAGES)
            damaged, out = folder / ('damaged' + whole.suffix), folder / 'out'
            damaged.write_bytes(damage(bytearray(whole.read_bytes()), dice))
            out.mkdir()
            fault, code = fault_of(damaged, out)
            if fault:
                faults += 1
                print(f'file {number}, {whole.name}, {damage.__name__}: {fault}', flush=True)
            codes[code] = codes.get(code, 0) + 1
            shutil.rmtree(out)
    summary = ', '.join(f'{count} with exit code {code}' for code, count in sorted(codes.items(), key=str))
    print(f'{len(FOUND) + COUNT} files: {summary}; {faults} faults')
    return 1 if faults or not COUNT else 0


if __name__ == '__main__':
    sys.exit(main())
