# SPDX-License-Identifier: MIT
"""The kinds of input that the command has to keep: each is made with FFmpeg's command, short and small.

The picture has four quarters of different colors with a moving texture, and shakes. So a test can see which way up it
is.
"""
import os
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

SECONDS = 1.6


def ffmpeg(*arguments):
    subprocess.run(['ffmpeg', '-nostdin', '-v', 'error', '-y', *map(str, arguments)], check=True)


def picture(width=320, height=240, rate=25, seconds=SECONDS):
    """A filter that renders the picture."""
    w, h = width + 48, height + 48
    quarters = ((0, 0, 'red'), (w // 2, 0, 'green'), (0, h // 2, 'blue'), (w // 2, h // 2, 'yellow'))
    boxes = ','.join(f'drawbox={x}:{y}:{w // 2 + 1}:{h // 2 + 1}:{color}@0.6:fill' for x, y, color in quarters)
    return (f'testsrc2=s={w}x{h}:r={rate}:d={seconds},{boxes},format=gbrp,'
            f"crop={width}:{height}:x='24+14*sin(2.1*n)':y='24+11*cos(1.7*n)':exact=1")


def video(width=320, height=240, rate=25, seconds=SECONDS):
    return ['-f', 'lavfi', '-i', picture(width, height, rate, seconds)]


def tone(hertz=440, seconds=SECONDS):
    return ['-f', 'lavfi', '-i', f'sine=frequency={hertz}:sample_rate=48000:duration={seconds}']


H264 = ['-c:v', 'libx264', '-preset', 'ultrafast', '-pix_fmt', 'yuv420p']
AAC = ['-c:a', 'aac', '-b:a', '64k']
HDR = ('colorprim=bt2020:transfer=smpte2084:colormatrix=bt2020nc:'
       'master-display=G(13250,34500)B(7500,3000)R(34000,16000)WP(15635,16450)L(10000000,50):'
       'max-cll=1000,400:log-level=none')


@dataclass
class Kind:
    """An input and what is expected of its output."""
    name: str
    suffix: str                    # of the input
    make: object                   # make(path): writes it
    out: str = None                # suffix of the output; None: that of the input
    codec: str = None              # of the output's picture; None: the input's
    audio: str = None              # of the output's sound; None: the input's
    lost: tuple = ()               # types of streams for which the container has no place
    tags: tuple = ()               # that have to be the same
    options: tuple = ()
    exit: int = 0
    frames: int = None             # number that is expected; None: that of the input
    odd: bool = False              # the size may shrink by one
    new_times: bool = False        # the input has no usable times
    notes: tuple = field(default=())  # words that stderr has to have


def simple(*encode, source=None, sound=True):
    def make(path):
        ffmpeg(*(source or video()), *(tone() if sound else []), *encode, path)
    return make


def metadata(folder):
    """Chapters, subtitles and tags, as files for FFmpeg."""
    chapters, subtitles = folder / 'chapters.txt', folder / 'subtitles.srt'
    chapters.write_text(';FFMETADATA1\ntitle=Holiday\nartist=A. Person\n'
                        '[CHAPTER]\nTIMEBASE=1/1000\nSTART=0\nEND=800\ntitle=one\n'
                        '[CHAPTER]\nTIMEBASE=1/1000\nSTART=800\nEND=1600\ntitle=two\n')
    subtitles.write_text('1\n00:00:00,200 --> 00:00:00,700\nHello\n\n2\n00:00:00,900 --> 00:00:01,400\nGood bye\n')
    return chapters, subtitles


def rich(subtitle_codec, *more):
    """Two audio tracks, subtitles, chapters, tags and time code."""
    def make(path):
        chapters, subtitles = metadata(path.parent)
        ffmpeg(*video(), *tone(440), *tone(880), '-i', subtitles, '-i', chapters,
               '-map', '0:v', '-map', '1:a', '-map', '2:a', '-map', '3:s', '-map_metadata', '4', '-map_chapters', '4',
               *H264, *AAC, '-c:s', subtitle_codec,
               '-metadata:s:a:0', 'language=eng', '-metadata:s:a:1', 'language=deu', '-metadata:s:s:0', 'language=fra',
               '-metadata', 'creation_time=2020-05-06T07:08:09Z', '-metadata', 'location=+48.8577+002.2950/',
               *more, path)
    return make


def turned(degrees):
    def make(path):
        upright = path.with_name(path.stem + '-upright.mp4')
        # The picture is stored lying on its side, as phones do, and the matrix turns it back.
        back = {0: 'null', 90: 'transpose=clock', 180: 'hflip,vflip', 270: 'transpose=cclock'}[degrees]
        ffmpeg(*video(), *tone(), '-vf', back, *H264, *AAC, upright)
        ffmpeg('-i', upright, '-c', 'copy', '-metadata:s:v', f'rotate={degrees}', path)
        upright.unlink()
    return make


def variable_rate(path):
    """A phone's frame times: 30 frames/s with jitter, and two pauses."""
    ffmpeg(*video(rate=30), *tone(), '-vf', "settb=1/90000,setpts='3000*N+400*sin(N*1.3)+if(gt(N,20),9000,0)'",
           '-vsync', 'passthrough', '-enc_time_base', '1/90000', '-video_track_timescale', '90000', *H264, *AAC, path)


def edit_list(path):
    """Begins between two key frames, so that the container has an edit list, and the sound begins earlier."""
    whole = path.with_name('whole.mp4')
    ffmpeg(*video(seconds=3), *tone(seconds=3), *H264, '-g', '30', '-bf', '2', *AAC, whole)
    ffmpeg('-ss', '0.6', '-i', whole, '-t', '1.6', '-c', 'copy', path)
    whole.unlink()


def late_picture(path):
    """The sound begins 0.4 s before the picture."""
    ffmpeg(*tone(), '-itsoffset', '0.4', *video(), '-map', '1:v', '-map', '0:a', *H264, *AAC, path)


def size_change(path):
    parts = []
    for number, (width, height) in enumerate(((320, 240), (400, 240))):
        part = path.with_name(f'part{number}.ts')
        ffmpeg(*video(width, height, seconds=0.8), *H264, '-output_ts_offset', number * 0.8, part)
        parts.append(part)
    path.write_bytes(b''.join(part.read_bytes() for part in parts))
    for part in parts:
        part.unlink()


def truncated(path):
    whole = path.with_name('whole.mp4')
    ffmpeg(*video(seconds=3), *H264, '-movflags', '+faststart', whole)
    data = whole.read_bytes()
    path.write_bytes(data[:len(data) * 6 // 10])
    whole.unlink()


def cover(path):
    image = path.with_name('cover.png')
    ffmpeg('-f', 'lavfi', '-i', 'color=orange:s=80x80', '-frames:v', '1', image)
    ffmpeg(*video(), *tone(), '-i', image, '-map', '0:v', '-map', '1:a', '-map', '2:v', *H264, '-c:v:1', 'png',
           '-disposition:v:1', 'attached_pic', *AAC, path)


def two_videos(path):
    ffmpeg(*video(), '-f', 'lavfi', '-i', f'color=gray:s=160x120:r=25:d={SECONDS}', '-map', '0:v', '-map', '1:v',
           *H264, path)


PRORES = ['-c:v', 'prores_ks', '-profile:v', '2', '-pix_fmt', 'yuv422p10le', '-vendor', 'apl0', '-c:a', 'pcm_s16le']
HDR10 = ['-c:v', 'libx265', '-preset', 'ultrafast', '-pix_fmt', 'yuv420p10le', '-x265-params', HDR, '-color_primaries',
         'bt2020', '-color_trc', 'smpte2084', '-colorspace', 'bt2020nc']
PHONE_TAGS = ['-metadata', 'com.apple.quicktime.make=Apple', '-metadata',
              'com.apple.quicktime.location.ISO6709=+48.8577+002.2950/']
KEPT_TAGS = ('title', 'artist', 'creation_time', 'location')

KINDS = [
    Kind('mp4-h264', 'mp4', simple(*H264, *AAC)),
    Kind('mp4-b-frames', 'mp4', simple(*H264, '-bf', '3', '-b_strategy', '0', *AAC)),
    Kind('mp4-rich', 'mp4', rich('mov_text', '-timecode', '01:02:03:04'), tags=(*KEPT_TAGS, 'timecode')),
    Kind('mov-rich', 'mov', rich('mov_text', '-timecode', '01:02:03:04'), tags=(*KEPT_TAGS, 'timecode')),
    Kind('mkv-rich', 'mkv', rich('subrip'), tags=KEPT_TAGS),
    Kind('mkv-rich-to-mp4', 'mkv', rich('subrip'), out='mp4', tags=('title', 'artist', 'creation_time')),
    Kind('mp4-rich-to-mkv', 'mp4', rich('mov_text', '-timecode', '01:02:03:04'), out='mkv', tags=(*KEPT_TAGS,
                                                                                                  'timecode')),
    Kind('mp4-hevc-hdr10', 'mp4', simple(*HDR10, '-tag:v', 'hvc1', *AAC)),
    Kind('mkv-hevc-hdr10', 'mkv', simple(*HDR10, *AAC)),
    Kind('webm-vp9-opus', 'webm', simple('-c:v', 'libvpx-vp9', '-cpu-used', '8', '-deadline', 'realtime', '-b:v', '1M',
                                         '-pix_fmt', 'yuv420p', '-c:a', 'libopus', '-b:a', '64k')),
    Kind('webm-vp8', 'webm', simple('-c:v', 'libvpx', '-cpu-used', '8', '-deadline', 'realtime', '-b:v', '1M',
                                    '-pix_fmt',
                                    'yuv420p', '-c:a', 'libvorbis'), codec='vp9'),
    Kind('mkv-av1', 'mkv', simple('-c:v', 'libaom-av1', '-cpu-used', '8', '-usage', 'realtime', '-crf', '40',
                                  '-pix_fmt',
                                  'yuv420p', *AAC)),
    Kind('mov-prores', 'mov', simple(*PRORES)),
    Kind('mov-pcm-to-mp4', 'mov', simple(*H264, '-c:a', 'pcm_s16le'), out='mp4', audio='aac', notes=('encoded anew',)),
    Kind('mkv-ffv1', 'mkv', simple('-c:v', 'ffv1', '-pix_fmt', 'yuv422p10le', '-c:a', 'flac')),
    Kind('avi-mjpeg', 'avi', simple('-c:v', 'mjpeg', '-q:v', '3', '-pix_fmt', 'yuvj422p', '-c:a', 'pcm_s16le'),
         out='mp4',
         codec='h264', audio='aac'),
    Kind('avi-mpeg4-b-frames', 'avi', simple('-c:v', 'mpeg4', '-bf', '2', '-q:v', '3', '-pix_fmt', 'yuv420p', '-c:a',
                                             'mp3'), out='mkv', codec='h264', new_times=True),
    Kind('avi-without-times', 'avi', simple(*H264, '-bf', '2', '-b_strategy', '0', '-c:a', 'mp3'), out='mkv',
         new_times=True),
    Kind('mp4-to-avi', 'mp4', simple(*H264, '-bf', '2', '-c:a', 'mp3'), out='avi', new_times=True),
    Kind('dv-interlaced', 'avi', simple('-target', 'pal-dv', '-flags', '+ilme+ildct', source=video(720, 576)),
         out='mkv',
         codec='h264'),
    Kind('ts-h264', 'ts', simple(*H264, '-bf', '2', *AAC)),
    Kind('ts-to-mp4', 'ts', simple(*H264, *AAC, '-output_ts_offset', '36000'), out='mp4'),
    Kind('mpg-mpeg2', 'mpg', simple('-c:v', 'mpeg2video', '-q:v', '3', '-pix_fmt', 'yuv420p', '-c:a', 'mp2'), out='mp4',
         codec='h264'),
    Kind('gif', 'gif', simple('-r', '10', sound=False, source=video(160, 120, 10)), out='mp4', codec='h264'),
    Kind('rotated-90', 'mp4', turned(90)),
    Kind('rotated-180', 'mp4', turned(180)),
    Kind('rotated-270', 'mov', turned(270)),
    Kind('rotated-90-to-mkv', 'mp4', turned(90), out='mkv'),
    Kind('rotated-270-to-webm', 'mp4', turned(270), out='webm', codec='vp9', audio='opus'),
    Kind('variable-rate', 'mp4', variable_rate),
    Kind('variable-rate-to-mkv', 'mp4', variable_rate, out='mkv'),
    Kind('240-frames-a-second', 'mp4', simple(*H264, *AAC, source=video(rate=240, seconds=0.5))),
    Kind('anamorphic', 'mp4', simple(*H264, '-aspect', '16:9', *AAC)),
    Kind('odd-width', 'mkv', simple('-c:v', 'ffv1', '-pix_fmt', 'yuv420p', source=video(321, 240), sound=False),
         out='mp4',
         codec='h264', odd=True, notes=('column is cut off',)),
    Kind('odd-both-to-hevc', 'mkv', simple('-c:v', 'ffv1', '-pix_fmt', 'yuv420p', source=video(321, 241), sound=False),
         out='mkv', codec='hevc', odd=True, options=('--encoder=hevc',), notes=('column and row are cut off',)),
    Kind('full-range', 'mp4', simple('-c:v', 'libx264', '-preset', 'ultrafast', '-pix_fmt', 'yuvj420p',
                                     '-color_range', 'pc',
                                     '-colorspace', 'bt709', '-color_primaries', 'bt709', '-color_trc', 'bt709', *AAC)),
    Kind('edit-list', 'mp4', edit_list),
    Kind('negative-times', 'mp4', simple(*H264, '-bf', '2', *AAC, '-avoid_negative_ts', 'disabled', '-output_ts_offset',
                                         '-0.4')),
    Kind('phone-tags', 'mov', simple(*H264, *AAC, '-movflags', 'use_metadata_tags', *PHONE_TAGS, '-metadata',
                                     'creation_time=2020-05-06T05:08:09Z'),
         tags=('com.apple.quicktime.make', 'com.apple.quicktime.location.iso6709', 'creation_time')),
    Kind('late-picture', 'mp4', late_picture),
    Kind('size-change', 'ts', size_change, out='mp4', notes=('size changes',)),
    Kind('one-frame', 'mp4', simple('-frames:v', '1', *H264, sound=False)),
    Kind('no-sound', 'mov', simple(*H264, sound=False)),
    Kind('cover-picture', 'mp4', cover),
    Kind('cover-picture-to-mkv', 'mp4', cover, out='mkv'),
    Kind('two-videos', 'mkv', two_videos, notes=('has 2 video streams',)),
    Kind('truncated', 'mp4', truncated, exit=6, notes=('truncated or damaged',)),
]


def make_all(folder):
    folder = Path(folder)
    for kind in KINDS:
        path = folder / f'{kind.name}.{kind.suffix}'
        if not path.exists():
            kind.make(path)


if __name__ == '__main__':
    import sys
    os.makedirs(sys.argv[1], exist_ok=True)
    make_all(sys.argv[1])
