# SPDX-License-Identifier: MIT
"""What is in a video file, by FFmpeg's own programs, and what differs between two."""
import json
import re
import subprocess


def ffprobe(path, *arguments):
    result = subprocess.run(['ffprobe', '-v', 'quiet', '-of', 'json', *arguments, str(path)], check=True,
                            stdout=subprocess.PIPE, encoding='utf-8', errors='replace')
    return json.loads(result.stdout)


class File:
    """The facts about a video file."""

    def __init__(self, path, stream=None):
        self.path = path
        data = ffprobe(path, '-show_streams', '-show_format', '-show_chapters')
        self.streams = [s for s in data['streams'] if s['codec_type'] != 'data']
        self.format = data['format']
        self.tags = {key.lower(): value for key, value in self.format.get('tags', {}).items()}
        self.chapters = [(round(float(c['start_time']), 2), round(float(c['end_time']), 2), c.get('tags',
                                                                                                  {}).get('title'))
                         for c in data['chapters']]
        pictures = [s for s in self.streams if s['codec_type'] == 'video' and not s['disposition']['attached_pic']]
        self.video = pictures[0]
        self.frames = self._frames()
        self.times = [float(f['best_effort_timestamp_time']) for f in self.frames if 'best_effort_timestamp_time' in f]

    def _frames(self):
        data = ffprobe(self.path, '-select_streams', str(self.video['index']), '-show_frames', '-show_entries',
                       'frame=best_effort_timestamp_time,width,height,pix_fmt,interlaced_frame,color_range,color_space,'
                       'color_primaries,color_transfer,sample_aspect_ratio:frame_side_data')
        return data['frames']

    def of_type(self, kind):
        return [s for s in self.streams if s['codec_type'] == kind]

    def audio(self):
        return self.of_type('audio')

    def tag(self, name):
        """A tag of the file, or of its picture."""
        tags = {key.lower(): value for key, value in self.video.get('tags', {}).items()}
        return self.tags.get(name) or tags.get(name)

    def depth(self):
        match = re.search(r'(10|12|16)(le|be)$', self.frames[0]['pix_fmt'])
        return int(match[1]) if match else 8

    def shape(self):
        """Width by height as it is shown."""
        frame = self.frames[0]
        ratio = frame.get('sample_aspect_ratio', '1:1')
        across, down = map(int, ratio.split(':')) if ratio not in ('N/A', '0:1') else (1, 1)
        shape = frame['width'] * across / (frame['height'] * down)
        return 1 / shape if self.rotation() % 180 else shape

    def rotation(self):
        for data in self.video.get('side_data_list', []):
            if 'rotation' in data:
                return int(data['rotation']) % 360
        return 0

    def hdr(self):
        """The HDR10 side data of the first frame, and of the container."""
        names = ('Mastering display metadata', 'Content light level metadata')
        found = {}
        for data in self.frames[0].get('side_data_list', []) + self.video.get('side_data_list', []):
            if data['side_data_type'] in names:
                found.update({key: _number(value) for key, value in data.items() if key != 'side_data_type'})
        return found

    def summary(self):
        """Container, size and streams, in a few words."""
        video = self.video
        words = [self.path.suffix[1:], f'{video["width"]}x{video["height"]}',
                 f'{video["codec_name"]} {self.frames[0]["pix_fmt"]}']
        words += [stream['codec_name'] for stream in self.streams if stream is not video]
        words += [f'{len(self.chapters)} chapters'] if self.chapters else []
        words += [f'turned {self.rotation()}'] if self.rotation() else []
        words += ['HDR10'] if self.hdr() else []
        return ', '.join(words)

    def subtitles(self):
        """The packets of each subtitle stream: time from the first frame, and text without marks."""
        texts = []
        for number in range(len(self.of_type('subtitle'))):
            text = subprocess.run(['ffmpeg', '-v', 'quiet', '-i', str(self.path), '-map', f'0:s:{number}', '-f',
                                   'srt', '-'],
                                  stdout=subprocess.PIPE, check=True).stdout.decode()
            lines = re.sub('<[^>]*>|{[^}]*}', '', text).split('\n')
            data = ffprobe(self.path, '-select_streams', f's:{number}', '-show_entries',
                           'packet=pts_time,duration_time,size')
            times = [round(float(p['pts_time']) - self.times[0], 2) for p in data['packets'] if int(p['size']) > 2]
            texts.append((times, [line for line in lines if line and '-->' not in line]))
        return texts

    def audio_packets(self, number):
        data = ffprobe(self.path, '-select_streams', f'a:{number}', '-show_entries',
                       'packet=pts_time,duration_time,size')
        return data['packets']

    def quarters(self):
        """The mean color of the four quarters of the first picture as a player shows it: which way up it is."""
        raw = subprocess.run(['ffmpeg', '-v', 'quiet', '-i', str(self.path), '-map', f'0:{self.video["index"]}',
                              '-frames:v',
                              '1', '-vf', 'format=rgb24,scale=2:2:flags=area', '-pix_fmt', 'rgb24', '-f',
                              'rawvideo', '-'],
                             stdout=subprocess.PIPE, check=True).stdout
        return [tuple(raw[i:i + 3]) for i in range(0, 12, 3)]


def _number(value):
    if isinstance(value, str) and '/' in value:
        over, under = map(int, value.split('/'))
        return round(over / under, 4)
    return value


def is_upright(quarters):
    """Whether red, green, blue and yellow are where kinds.picture() has them."""
    names = []
    for red, green, blue in quarters:
        names.append('blue' if blue > max(red, green) else 'yellow' if min(red, green) > 128 else
                     'red' if red > green else 'green')
    return names == ['red', 'green', 'blue', 'yellow']


def compare(before, after, kind):
    """Yields what the output has lost, in words."""
    yield from _compare_streams(before, after, kind)
    yield from _compare_times(before, after, kind)
    yield from _compare_picture(before, after, kind)
    for tag in kind.tags:
        if before.tag(tag) != after.tag(tag):
            yield f'tag {tag}: {before.tag(tag)} is now {after.tag(tag)}'
    if before.chapters != after.chapters:
        yield f'chapters: {before.chapters} are now {after.chapters}'


def _compare_streams(before, after, kind):
    for name in ('video', 'audio', 'subtitle'):
        had, has = before.of_type(name), after.of_type(name)
        if name in kind.lost:
            continue
        if len(had) != len(has):
            yield f'{len(had)} {name} streams are now {len(has)}'
        for old, new in zip(had, has):
            if old.get('tags', {}).get('language', 'und') != new.get('tags', {}).get('language', 'und'):
                yield f'the language of a {name} stream'
            # MP4 has one name for all layers of MPEG-1 audio.
            same = {old['codec_name'], new['codec_name']} == {'mp2', 'mp3'}
            if name == 'audio' and not same and new['codec_name'] != (kind.audio or old['codec_name']):
                yield f'audio {old["codec_name"]} is now {new["codec_name"]}'
    if after.video['codec_name'] != (kind.codec or before.video['codec_name']):
        yield f'the picture is {after.video["codec_name"]}'
    if before.subtitles() != after.subtitles():
        yield f'subtitles: {before.subtitles()} are now {after.subtitles()}'


def _compare_times(before, after, kind):
    wanted = kind.frames or len(before.frames)
    if len(after.frames) != wanted:
        yield f'{wanted} frames are now {len(after.frames)}'
        return
    frame = (before.times[-1] - before.times[0]) / max(1, len(before.times) - 1) or 0.04
    if kind.new_times:  # FFmpeg has to guess when the first frame is shown: up to as many frames late as are reordered
        frame *= 3
    if not kind.new_times:
        worst = max(abs((a - after.times[0]) - (b - before.times[0])) for a, b in zip(after.times, before.times))
        if worst > 0.0011:  # Matroska and FLV count milliseconds
            yield f'a frame is moved by {worst:.4f} s'
    for number, (old, new) in enumerate(zip(before.audio(), after.audio())):
        packets, kept = before.audio_packets(number), after.audio_packets(number)
        if kind.audio is None and len(packets) != len(kept):
            yield f'{len(packets)} packets of sound are now {len(kept)}'
        repacked = before.format['format_name'] == 'mpegts' != after.format['format_name']  # each packet loses a header
        sizes = [sum(int(p['size']) for p in each) for each in (packets, kept)]
        if kind.audio is None and not repacked and sizes[0] != sizes[1]:
            yield 'the sound is not a copy'
        drift = (float(kept[0]['pts_time']) - after.times[0]) - (float(packets[0]['pts_time']) - before.times[0])
        if abs(drift) > frame:
            yield f'the sound is off by {drift:.3f} s'
    long, now = float(before.format['duration']), float(after.format['duration'])
    if before.format['format_name'] != 'mpegts' and kind.exit == 0 and abs(long - now) > frame + (0.05 if kind.audio
                                                                                                  else 0.025):
        yield f'duration: {long} s is now {now} s'


def _compare_picture(before, after, kind):
    old, new = before.frames[0], after.frames[0]
    if abs(before.shape() / after.shape() - 1) > (0.01 if kind.odd else 0.0001):
        yield f'shape: {before.shape():.4f} is now {after.shape():.4f}'
    if after.depth() < before.depth():
        yield f'{before.depth()} bits are now {after.depth()}'
    for key in ('color_space', 'color_primaries', 'color_transfer', 'color_range'):
        had, has = (f.get(key, 'unknown').replace('bt470bg', 'smpte170m') for f in (old,
                                                                                    new))  # two names of one matrix
        if had not in ('unknown', 'gbr', 'reserved') and had != has:
            yield f'{key}: {had} is now {has}'
    if before.hdr() != after.hdr():
        yield f'HDR: {before.hdr()} is now {after.hdr()}'
    if int(new.get('interlaced_frame', 0)):
        yield 'the output is interlaced'
    if not is_upright(after.quarters()):
        yield f'the picture is not upright: {after.quarters()}'
    for was, is_now in zip(before.quarters(), after.quarters()):
        if max(abs(a - b) for a, b in zip(was, is_now)) > 48:
            yield f'the picture is turned: {before.quarters()} are now {after.quarters()}'
            break
