#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""From the same decoded frames, the filter and the GStreamer element make the same frames, to the bit."""
import hashlib
import os
import subprocess
import unittest
from pathlib import Path

import small_ffmpeg
import clip
from clip import Gst, HEIGHT, WIDTH

FRAMES = 40
WINDOW = 12
CLIP_FRAMES = 100
CLIPS = Path(os.environ.get('CLIPS_DIR', 'no folder'))

# FFmpeg's formats, and those of GStreamer that the library gets as the same. Later versions of FFmpeg have more.
FORMATS = {
    'yuv420p': 'I420', 'yuvj420p': 'I420', 'nv12': 'NV12', 'nv21': 'NV21', 'yuv422p': 'Y42B', 'yuvj422p': 'Y42B',
    'nv16': 'NV16', 'yuyv422': 'YUY2', 'uyvy422': 'UYVY', 'yvyu422': 'YVYU', 'yuv444p': 'Y444', 'yuvj444p': 'Y444',
    'nv24': 'NV24', 'yuv411p': 'Y41B', 'yuva420p': 'A420', 'bgr0': 'BGRx', 'rgb0': 'RGBx', '0rgb': 'xRGB',
    '0bgr': 'xBGR', 'bgra': 'BGRA', 'rgba': 'RGBA', 'argb': 'ARGB', 'abgr': 'ABGR', 'bgr24': 'BGR', 'rgb24': 'RGB',
    'gbrp': 'GBR', 'gbrap': 'GBRA', 'gray': 'GRAY8', 'yuv420p10le': 'I420_10LE', 'yuv420p12le': 'I420_12LE',
    'yuv422p10le': 'I422_10LE', 'yuv422p12le': 'I422_12LE', 'yuv444p10le': 'Y444_10LE', 'yuv444p12le': 'Y444_12LE',
    'yuv444p16le': 'Y444_16LE', 'yuva420p10le': 'A420_10LE', 'yuva422p10le': 'A422_10LE',
    'yuva444p10le': 'A444_10LE', 'p010le': 'P010_10LE', 'p016le': 'P016_LE', 'gbrp10le': 'GBR_10LE',
    'gbrp12le': 'GBR_12LE', 'gbrap10le': 'GBRA_10LE', 'gbrap12le': 'GBRA_12LE', 'rgba64le': 'RGBA64_LE',
    'bgra64le': 'BGRA64_LE', 'ayuv64le': 'AYUV64', 'gray16le': 'GRAY16_LE',
}
if small_ffmpeg.VERSION != '5.1':
    FORMATS.update({'vuya': 'VUYA', 'vuyx': 'VUYA', 'p012le': 'P012_LE'})
# What FFmpeg has no format for (ARGB64 is ARGB64_LE under another name).
ABSENT = {'YV12', 'NV61', 'VYUY', 'AV12', 'AYUV', 'ARGB64', 'ARGB64_LE', 'ABGR64_LE'}
if small_ffmpeg.VERSION == '5.1':
    ABSENT |= {'VUYA', 'P012_LE'}



def colored(picture):
    """The picture with its luma, at half the size, in its chroma planes too."""
    luma = picture[:WIDTH * HEIGHT]
    blue = b''.join(luma[y * WIDTH:(y + 1) * WIDTH:2] for y in range(0, HEIGHT, 2))
    return luma + blue + bytes(255 - c for c in blue)


clip.begin(elements=['rawvideoparse', 'capssetter'], seconds=1800)
folder = clip.folder()
film = folder / 'film.yuv'
film.write_bytes(b''.join(map(colored, clip.pictures(FRAMES))))


def by_element(pipeline, frames):
    """The MD5 of each frame that a pipeline makes."""
    out = folder / 'element.raw'
    subprocess.run(f'gst-launch-1.0 -q {pipeline} ! filesink location={out}', shell=True, check=True, timeout=120)
    data = out.read_bytes()
    size, rest = divmod(len(data), frames)
    assert size and not rest
    return [hashlib.md5(data[i:i + size]).hexdigest() for i in range(0, len(data), size)]


def interleaved(path):
    """Raw frames of yuv422p as nv16, which swscale does not write."""
    data, luma, chroma = path.read_bytes(), WIDTH * HEIGHT, WIDTH * HEIGHT // 2
    for start in range(0, len(data), 2 * luma):
        pairs = bytearray(2 * chroma)
        pairs[::2] = data[start + luma:start + luma + chroma]
        pairs[1::2] = data[start + luma + chroma:start + 2 * luma]
        yield data[start:start + luma] + pairs


def converted(pixel_format):
    """The film in another pixel format, as raw frames."""
    path = folder / f'{pixel_format}.raw'
    if pixel_format == 'nv16':
        path.write_bytes(b''.join(interleaved(converted('yuv422p'))))
    else:
        small_ffmpeg.run('-v', 'error', '-y', *small_ffmpeg.raw(film, WIDTH, HEIGHT), '-pix_fmt', pixel_format,
                         '-f', 'rawvideo', path)
    return path


def parsed(path, gst_format, more='', width=WIDTH, height=HEIGHT):
    """A piece of pipeline that reads raw frames. The caps have no chroma site unless `more` has it."""
    return (f'filesrc location={path} ! rawvideoparse use-sink-caps=false width={width} height={height} '
            f'framerate=30/1 format={gst_format.lower().replace("_", "-")} ! capssetter replace=true caps=video/x-raw,'
            f'format={gst_format},width={width},height={height},framerate=30/1{more}')


def decoded(path):
    """The first frames of a clip as raw frames; their number; their size, which is made a multiple of 16."""
    out = folder / 'decoded.yuv'
    probe = Gst.parse_launch(f'filesrc location={path} ! decodebin ! fakesink name=sink')
    probe.set_state(Gst.State.PAUSED)
    probe.get_state(10 * Gst.SECOND)
    caps = probe.get_by_name('sink').get_static_pad('sink').get_current_caps().get_structure(0)
    probe.set_state(Gst.State.NULL)
    width, height = caps.get_int('width')[1] & -16, caps.get_int('height')[1] & -16
    clip.play(f'filesrc location={path} ! decodebin ! identity eos-after={CLIP_FRAMES + 1} ! videoconvert ! videoscale '
              f'! video/x-raw,format=I420,width={width},height={height} ! filesink location={out}')
    return out, out.stat().st_size // (width * height * 3 // 2), width, height


class Identical(unittest.TestCase):
    def assert_identical(self, element, *ffmpeg, frames=FRAMES, **options):
        wanted = by_element(element, frames)
        made = [f.md5 for f in small_ffmpeg.frames_of(*ffmpeg, **options)]
        self.assertEqual(len(made), frames)
        self.assertEqual(made, wanted)
        self.assertGreater(len(set(made)), 1)

    def test_raw_frames_are_stabilized_to_the_same_bits(self):
        self.assert_identical(f'{parsed(film, "I420")} ! l1l2stab', *small_ffmpeg.raw(film, WIDTH, HEIGHT),
                              '-vf', 'l1l2stab')

    def test_every_setting_does_the_same(self):
        for settings in ('lambda=0.05', 'lambda=3 crop-ratio=0.75', 'overlap=4', 'join=blend', 'interpolation=lanczos',
                         'interpolation=bilinear', 'motion-model=affine', 'motion-model=translation',
                         'rolling-shutter=none', 'rolling-shutter=homography', 'output-size=crop', 'bypass=true',
                         'border=fill crop-ratio=0.8 fill-frames=8', 'border=extend', 'region=0,0,50%,60%',
                         'region=10,20,100,90'):
            with self.subTest(settings=settings):
                options = ':'.join([f'window={WINDOW}', *settings.replace('-', '_').replace(',', '\\,').split()])
                self.assert_identical(f'{parsed(film, "I420")} ! l1l2stab window={WINDOW} {settings}',
                                      *small_ffmpeg.raw(film, WIDTH, HEIGHT), '-vf', f'l1l2stab={options}')

    def test_every_pixel_format_is_taken_as_it_is_and_gives_the_same_bits(self):
        for ff, gst in FORMATS.items():
            with self.subTest(format=ff):
                path = converted(ff)
                words = [*small_ffmpeg.raw(path, WIDTH, HEIGHT, ff), '-vf', f'l1l2stab=window={WINDOW}']
                self.assert_identical(f'{parsed(path, gst)} ! l1l2stab window={WINDOW}', *words)
                messages = small_ffmpeg.run('-v', 'verbose', *words, '-f', 'null', '-')[1]
                self.assertNotIn('auto_scale', messages)
                path.unlink()

    def test_the_formats_that_are_missing_are_those_that_ffmpeg_lacks(self):
        caps = Gst.ElementFactory.make('l1l2stab').get_static_pad('sink').get_pad_template().get_caps()
        all_formats = set(caps.get_structure(0).get_value('format'))
        self.assertEqual(all_formats - set(FORMATS.values()), ABSENT)

    def test_pixels_that_are_not_square_are_stabilized_in_the_picture_as_it_is_shown(self):
        element = f'{parsed(film, "I420", ",pixel-aspect-ratio=2/1")} ! l1l2stab window={WINDOW}'
        self.assert_identical(element, *small_ffmpeg.raw(film, WIDTH, HEIGHT),
                              '-vf', f'setsar=2/1,l1l2stab=window={WINDOW}')
        self.assertNotEqual(by_element(element, FRAMES),
                            by_element(f'{parsed(film, "I420")} ! l1l2stab window={WINDOW}', FRAMES))

    def test_chroma_is_warped_where_the_frames_say_that_it_lies(self):
        made = {}
        for ff, gst in {'unspecified': None, 'left': 'mpeg2', 'center': 'jpeg', 'topleft': 'cosited'}.items():
            with self.subTest(site=ff):
                site = f',chroma-site={gst}' if gst else ''
                element = f'{parsed(film, "I420", site)} ! l1l2stab window={WINDOW}'
                self.assert_identical(element, '-chroma_sample_location', ff, *small_ffmpeg.raw(film, WIDTH, HEIGHT),
                                      '-vf', f'l1l2stab=window={WINDOW}')
                made[ff] = by_element(element, FRAMES)[-1]
        self.assertEqual(made['left'], made['unspecified'])
        self.assertEqual(len(set(made.values())), 3)

    @unittest.skipIf(small_ffmpeg.VERSION != '5.1', 'since 7.1 setpts takes the frame rate away, without which the '
                     'spacing of frames does not count')
    def test_frames_that_are_not_evenly_spaced_have_the_same_path(self):
        out = folder / 'uneven.raw'
        pipeline = Gst.parse_launch(
            f'appsrc name=source format=time max-bytes=0 caps=video/x-raw,format=I420,width={WIDTH},height={HEIGHT},'
            f'framerate=30/1 ! l1l2stab window={WINDOW} ! filesink location={out}')
        pipeline.set_state(Gst.State.PLAYING)
        clip.feed(pipeline.get_by_name('source'), map(colored, clip.pictures(FRAMES)),
                  lambda i: round((i + i % 2 / 2) * 3000 * Gst.SECOND / 90000))
        clip.wait(pipeline)
        data, size = out.read_bytes(), WIDTH * HEIGHT * 3 // 2
        wanted = [hashlib.md5(data[i:i + size]).hexdigest() for i in range(0, len(data), size)]

        frames = small_ffmpeg.frames_of(
            *small_ffmpeg.raw(film, WIDTH, HEIGHT), '-fps_mode', 'passthrough', '-enc_time_base', '1/90000',
            '-vf', f'settb=1/90000,setpts=(N+mod(N\\,2)/2)*3000,l1l2stab=window={WINDOW}')
        self.assertEqual([f.pts for f in frames], [3000 * i + 1500 * (i % 2) for i in range(FRAMES)])
        self.assertEqual([f.md5 for f in frames], wanted)
        self.assertNotEqual(wanted, by_element(f'{parsed(film, "I420")} ! l1l2stab window={WINDOW}', FRAMES))

    def test_a_compressed_file_gives_the_same_bits(self):
        path = clip.make(folder / 'film.mov', FRAMES)
        self.assert_identical(
            f'filesrc location={path} ! qtdemux ! h264parse ! avdec_h264 ! l1l2stab lambda=0.5',
            '-i', path, '-vf', 'l1l2stab=lambda=0.5', '-fps_mode', 'passthrough')

    @unittest.skipUnless(CLIPS.is_dir(), 'the folder of real clips is absent')
    def test_real_clips_are_stabilized_to_the_same_bits(self):
        for path in sorted(p for p in CLIPS.iterdir() if p.suffix != '.tsv'):
            with self.subTest(clip=path.name):
                raw, frames, width, height = decoded(path)
                self.assertGreater(frames, CLIP_FRAMES // 2)
                self.assert_identical(f'{parsed(raw, "I420", "", width, height)} ! l1l2stab window=60',
                                      *small_ffmpeg.raw(raw, width, height), '-vf', 'l1l2stab=window=60', frames=frames)


if __name__ == '__main__':
    unittest.main(verbosity=2)
