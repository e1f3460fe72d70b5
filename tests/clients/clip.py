# SPDX-License-Identifier: MIT
"""A shaky clip whose frames show their number, and functions that read a client's output file.

The camera looks at a wall of random tiles and shakes by up to SHAKE pixels. On the wall is the frame's number: eight
large blocks, white for 1, which can be read wherever the stabilizer moves them. With audio, there is a flash of light
for FLASH_FRAMES frames every second, and a beep that begins with it.
"""
import array
import atexit
import faulthandler
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

SKIPPED = 77

try:
    import gi
    gi.require_version('Gst', '1.0')
    gi.require_version('GstVideo', '1.0')
    from gi.repository import Gst, GstVideo
except (ImportError, ValueError) as reason:
    print('skipped: no Python bindings of GStreamer:', reason)
    sys.exit(SKIPPED)

WIDTH, HEIGHT, FPS = 320, 240, 30
SHAKE = 5  # pixels
TILE, BLOCK = 8, 24  # pixels
FLASH_FRAMES = 2
RATE, BEEP_HZ, BEEP_SECONDS = 48000, 1000, 0.1
FRAME = Gst.SECOND / FPS

# Half a minute is enough for each of these programs. A program that takes this long is stuck.
WATCHDOG_SECONDS = 100

WALL_WIDTH, WALL_HEIGHT = WIDTH + 2 * SHAKE, HEIGHT + 2 * SHAKE
LIGHT, DARK, WHITE, BLACK = 200, 40, 235, 16
MIDDLE = (WHITE + BLACK) // 2


class Frame(NamedTuple):
    time: int       # stream time, nanoseconds
    number: int     # as read from the picture, modulo 256
    luma: float     # mean of the upper edge of the frame: shows a flash
    edge: bytes     # some rows of the upper edge: shows how much the picture moves


def begin(*programs, elements=(), seconds=WATCHDOG_SECONDS):
    """To be called first: starts the watchdog and GStreamer, and skips the test if something it needs is missing."""
    faulthandler.dump_traceback_later(seconds, exit=True)
    Gst.init(None)
    missing = [p for p in programs if not shutil.which(p)]
    missing += [e for e in ('x264enc', 'mp4mux', *elements) if not Gst.ElementFactory.find(e)]
    if missing:
        print('skipped: not installed:', *missing)
        sys.exit(SKIPPED)
    if not Gst.ElementFactory.find('l1l2stab'):
        sys.exit('there is no l1l2stab: GST_PLUGIN_PATH has to name its folder')


def folder():
    """A folder that lives as long as the program."""
    path = tempfile.mkdtemp(prefix='l1l2stab-')
    owner = os.getpid()
    atexit.register(lambda: os.getpid() == owner and shutil.rmtree(path, ignore_errors=True))
    return Path(path)


# ---- the clip ----

def wall():
    """Rows of luma. with_number() draws the number of a frame on them."""
    dice = random.Random(1)
    rows = []
    for _ in range(-(-WALL_HEIGHT // TILE)):
        row = b''.join(bytes([dice.randrange(DARK, LIGHT)]) * TILE for _ in range(-(-WALL_WIDTH // TILE)))
        rows += [row[:WALL_WIDTH]] * TILE
    return rows[:WALL_HEIGHT]


def with_number(rows, number):
    """The number's eight blocks, four in a row, the highest bit first, in the middle of the wall."""
    rows = list(rows)
    x, y = WALL_WIDTH // 2 - 2 * BLOCK, WALL_HEIGHT // 2 - BLOCK
    for half in range(2):
        bits = [number >> (7 - 4 * half - i) & 1 for i in range(4)]
        blocks = b''.join(bytes([WHITE if bit else BLACK]) * BLOCK for bit in bits)
        for i in range(y + half * BLOCK, y + (half + 1) * BLOCK):
            rows[i] = rows[i][:x] + blocks + rows[i][x + len(blocks):]
    return rows


def is_flash(number):
    return number >= FPS and number % FPS < FLASH_FRAMES


def pictures(count, flashes=False):
    """I420 frames, as bytes. The shake is like that of a hand: small random steps."""
    still = wall()
    chroma = bytes([128]) * (WIDTH * HEIGHT // 2)
    dice = random.Random(2)
    x = y = SHAKE
    for number in range(count):
        rows = [bytes([WHITE]) * WALL_WIDTH] * WALL_HEIGHT if flashes and is_flash(number) else still
        rows = with_number(rows, number % 256)
        yield b''.join(row[x:x + WIDTH] for row in rows[y:y + HEIGHT]) + chroma
        x = min(max(x + dice.randint(-3, 3), 0), 2 * SHAKE)
        y = min(max(y + dice.randint(-3, 3), 0), 2 * SHAKE)


def sound(seconds):
    beep = [int(12000 * math.sin(2 * math.pi * BEEP_HZ * i / RATE)) for i in range(int(BEEP_SECONDS * RATE))]
    samples = array.array('h', bytes(2 * int(seconds * RATE)))
    for second in range(1, math.ceil(seconds)):
        part = samples[second * RATE:second * RATE + len(beep)]
        samples[second * RATE:second * RATE + len(part)] = array.array('h', beep[:len(part)])
    return samples.tobytes()


def feed(source, chunks, duration_of):
    """Pushes pieces of a stream, one after the other, with their times."""
    time = 0
    for i, chunk in enumerate(chunks):
        buffer = Gst.Buffer.new_wrapped(chunk)
        buffer.pts = time
        time = duration_of(i + 1)
        buffer.duration = time - buffer.pts
        source.emit('push-buffer', buffer)
    source.emit('end-of-stream')


def make(path, frames=90, audio=False):
    """Writes the clip as QuickTime: H.264 with a key frame every half second, and lossless audio."""
    description = (
        f'appsrc name=video format=time max-bytes=0 caps=video/x-raw,format=I420,width={WIDTH},height={HEIGHT},'
        f'framerate={FPS}/1 ! x264enc speed-preset=superfast pass=qual quantizer=18 key-int-max=15 ! h264parse ! '
        f'mp4mux name=mux ! filesink location={path}')
    if audio:
        description += (
            f' appsrc name=audio format=time max-bytes=0 caps=audio/x-raw,format=S16LE,layout=interleaved,rate={RATE},'
            'channels=1 ! audioconvert ! avenc_alac ! queue max-size-time=0 ! mux.audio_0')
    pipeline = Gst.parse_launch(description)
    pipeline.set_state(Gst.State.PLAYING)
    feed(pipeline.get_by_name('video'), pictures(frames, flashes=audio), lambda i: i * Gst.SECOND // FPS)
    if audio:
        samples = sound(frames / FPS)
        step = 2 * RATE // 100
        feed(pipeline.get_by_name('audio'), [samples[i:i + step] for i in range(0, len(samples), step)],
             lambda i: i * Gst.SECOND // 100)
    wait(pipeline)
    return path


# ---- what came out ----

def wait(pipeline, seconds=30):
    """Waits for the end of the stream and stops the pipeline. Raises the error of the pipeline, if there is one."""
    message = pipeline.get_bus().timed_pop_filtered(
        seconds * Gst.SECOND, Gst.MessageType.EOS | Gst.MessageType.ERROR)
    pipeline.set_state(Gst.State.NULL)
    if message is None:
        raise TimeoutError(f'no end after {seconds} s')
    if message.type == Gst.MessageType.ERROR:
        raise RuntimeError(message.parse_error())


def play(description):
    """Runs a pipeline to its end."""
    pipeline = Gst.parse_launch(description)
    pipeline.set_state(Gst.State.PLAYING)
    wait(pipeline)


def read_number(luma, width, height, zoom=1.05):
    """The number in a picture, read in the middle of each block. The blocks are large, so the zoom can be rough."""
    number = 0
    for i in range(8):
        x = width // 2 + round(zoom * BLOCK * (i % 4 - 1.5))
        y = height // 2 + round(zoom * BLOCK * (i // 4 - 0.5))
        bright = sum(sum(luma[row * width + x - 2:row * width + x + 3]) for row in range(y - 2, y + 3))
        number = number << 1 | (bright > 25 * MIDDLE)
    return number


def time_of(sample):
    """The stream time of a sample. The timestamps of a file can begin anywhere; its segment says where."""
    return sample.get_segment().to_stream_time(Gst.Format.TIME, sample.get_buffer().pts)


def frame_of(sample, zoom=1.05):
    """A Frame from a GRAY8 sample."""
    info = GstVideo.VideoInfo.new_from_caps(sample.get_caps())
    width, height = info.width, info.height
    buffer = sample.get_buffer()
    luma = buffer.extract_dup(0, buffer.get_size())
    stride = len(luma) // height
    luma = b''.join(luma[row * stride:row * stride + width] for row in range(height))
    edge = luma[10 * width:(10 + 8) * width]
    return Frame(time_of(sample), read_number(luma, width, height, zoom), sum(edge) / len(edge), edge[::2])


def frames_of(source):
    """The frames of a file, or of a piece of pipeline that ends in raw video."""
    if isinstance(source, Path):
        source = f'filesrc location={source} ! decodebin'
    pipeline = Gst.parse_launch(
        f'{source} ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=sink sync=false max-buffers=4')
    sink = pipeline.get_by_name('sink')
    pipeline.set_state(Gst.State.PLAYING)
    frames = []
    while (sample := sink.emit('try-pull-sample', 30 * Gst.SECOND)) is not None:
        frames.append(frame_of(sample))
    wait(pipeline)
    return frames


def samples_of(path):
    """The audio of a file: (time of its first sample in nanoseconds, samples at RATE, one channel)."""
    pipeline = Gst.parse_launch(
        f'filesrc location={path} ! decodebin ! audioconvert ! audioresample ! audio/x-raw,format=S16LE,rate={RATE},'
        'channels=1 ! appsink name=sink sync=false')
    sink = pipeline.get_by_name('sink')
    pipeline.set_state(Gst.State.PLAYING)
    start, samples = None, array.array('h')
    while (sample := sink.emit('try-pull-sample', 30 * Gst.SECOND)) is not None:
        buffer = sample.get_buffer()
        start = time_of(sample) if start is None else start
        samples.frombytes(buffer.extract_dup(0, buffer.get_size()))
    wait(pipeline)
    return start, samples


def unrest(frames):
    """How much the picture moves: mean absolute difference of the upper edges of successive frames, without flashes."""
    total = count = 0
    for a, b in zip(frames, frames[1:]):
        if a.luma < WHITE - 30 and b.luma < WHITE - 30:
            total += sum(map(abs, (p - q for p, q in zip(a.edge, b.edge))))
            count += len(a.edge)
    return total / count


def run(*command, seconds=40, **environment):
    """Runs a program to its end and returns its output. Raises an error if its exit status is not 0."""
    result = subprocess.run([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                            stderr=subprocess.STDOUT, timeout=seconds, text=True, errors='replace',
                            env={**os.environ, **environment}, check=False)
    if result.returncode != 0:
        raise RuntimeError(f'{command[0]} ended with {result.returncode}:\n{result.stdout}')
    return result.stdout
