#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The filter l1l2stab in ffmpeg: files, filtergraphs, live input, commands, changes and ends of the stream."""
import os
import re
import subprocess
import threading
import time
import unittest

import small_ffmpeg
import clip
from clip import HEIGHT, WIDTH
from small_ffmpeg import frames_of, run

FRAMES = 60
WINDOW = 12
PICTURE = WIDTH * HEIGHT * 3 // 2  # bytes

clip.begin(seconds=600)
folder = clip.folder()
film = folder / 'film.yuv'
film.write_bytes(b''.join(clip.pictures(FRAMES)))
source = small_ffmpeg.raw(film, WIDTH, HEIGHT)
movie = clip.make(folder / 'film.mov', FRAMES, audio=True)


def filtered(graph, *words, of=None, **options):
    return frames_of(*words, *(of or source), '-vf', graph, **options)


def probe(path, entries):
    text = run('-v', 'error', '-select_streams', 'v', '-show_entries', entries, '-of', 'csv=p=0', path,
               program='ffprobe')[0].decode()
    return [line.strip(',') for line in text.split()]


def md5s(frames):
    return [f.md5 for f in frames]


def times(frames):
    return [f.pts for f in frames]


class Files(unittest.TestCase):
    def test_one_command_stabilizes_a_file_and_keeps_its_audio_and_every_time(self):
        out = folder / 'out.mp4'
        run('-i', movie, '-vf', 'l1l2stab=lambda=0.5', out)
        self.assertEqual(sorted(probe(out, 'packet=pts_time'), key=float),
                         sorted(probe(movie, 'packet=pts_time'), key=float))
        streams = run('-v', 'error', '-show_entries', 'stream=codec_type', '-of', 'csv=p=0', out, program='ffprobe')[0]
        self.assertEqual(streams.decode().split(), ['video', 'audio'])
        before, after = (clip.unrest(clip.frames_of(path)) for path in (movie, out))
        self.assertLess(after, 0.7 * before)

    def test_ten_bits_and_colors_are_kept(self):
        out = folder / 'deep.mkv'
        run(*source, '-vf', 'format=yuv420p10le,setparams=range=tv:color_primaries=bt2020:color_trc=smpte2084:'
            f'colorspace=bt2020nc,l1l2stab=window={WINDOW}', '-c:v', 'ffv1', out)
        self.assertEqual(
            probe(out, 'stream=pix_fmt,color_range,color_space,color_transfer,color_primaries')[0].split(','),
            ['yuv420p10le', 'tv', 'bt2020nc', 'smpte2084', 'bt2020'])
        self.assertEqual(len(probe(out, 'packet=pts')), FRAMES)

    def test_side_data_and_frame_types_come_out_with_their_own_frame(self):
        def shown(graph):
            messages = run('-i', movie, '-vf', f'{graph}showinfo', '-f', 'null', '-')[1]
            return re.findall(r' pts: *(\d+) .*iskey:(\d) type:(\w)', messages), messages.count('Regions Of Interest')

        before, _ = shown('')
        after, regions = shown(f'addroi=x=10:y=10:w=50:h=50:qoffset=0.1,l1l2stab=window={WINDOW},')
        self.assertEqual(after, before)
        self.assertEqual(len(after), FRAMES)
        self.assertGreater(len({kind for _, _, kind in after}), 1)
        self.assertEqual(regions, FRAMES)

    def test_after_a_seek_every_frame_from_there_is_stabilized(self):
        words = ['-ss', '0.7', '-i', movie, '-an', '-fps_mode', 'passthrough', '-copyts']
        plain = frames_of(*words)
        steady = frames_of(*words, '-vf', f'l1l2stab=window={WINDOW}')
        self.assertEqual(times(steady), times(plain))
        self.assertLess(len(steady), FRAMES)
        self.assertGreater(len(steady), FRAMES // 2)


class Ends(unittest.TestCase):
    def test_a_stream_that_is_shorter_than_the_window_comes_out_whole(self):
        for count in (0, 1, 2, 3, 7, 149, 150, 151):
            with self.subTest(frames=count):
                frames = frames_of('-f', 'lavfi', '-i', 'testsrc2=size=64x48:rate=30', '-vf',
                                   f'trim=end_frame={count},l1l2stab')
                self.assertEqual(times(frames), [*range(count)])

    def test_a_filter_that_wants_no_more_frames_ends_the_stream(self):
        self.assertEqual(len(filtered(f'l1l2stab=window={WINDOW},trim=end_frame=5')), 5)
        self.assertEqual(len(filtered(f'l1l2stab=window={WINDOW}', '-nostdin', of=[*source, '-frames:v', '5'])), 5)

    def test_timestamps_come_out_as_they_came_in(self):
        for expression in ('N*7+1000', 'N*N', 'N+3*mod(N\\,2)', 'PTS-40'):
            with self.subTest(setpts=expression):
                words = [*source, '-fps_mode', 'passthrough', '-copyts', '-enc_time_base', '1/1000']
                graph = f'settb=1/1000,setpts={expression}'
                self.assertEqual(times(frames_of(*words, '-vf', f'{graph},l1l2stab=window={WINDOW}')),
                                 times(frames_of(*words, '-vf', graph)))


class Graphs(unittest.TestCase):
    def test_the_delayed_branch_meets_the_other_one_frame_by_frame(self):
        both = f'split[a][b];[b]l1l2stab=window={WINDOW}[c];[a][c]hstack'
        frames = filtered(both)
        self.assertEqual(times(frames), [*range(FRAMES)])
        self.assertEqual(md5s(filtered(f'{both},crop={WIDTH}:{HEIGHT}:0:0')), md5s(filtered('null')))
        self.assertEqual(md5s(filtered(f'{both},crop={WIDTH}:{HEIGHT}:{WIDTH}:0')),
                         md5s(filtered(f'l1l2stab=window={WINDOW}')))

    def test_overlays_and_two_filters_in_one_graph_lose_no_frame(self):
        frames = filtered('split=3[a][b][c];[b]l1l2stab=window=30,scale=80:60[d];[c]l1l2stab=window=7,scale=80:60[e];'
                          '[a][d]overlay[f];[f][e]overlay=x=100')
        self.assertEqual(times(frames), [*range(FRAMES)])

    def test_frames_are_referenced_and_not_copied(self):
        # A second branch that holds the same frames takes no memory for them, because both refer to the same pixels.
        size, window = (1280, 720), 60

        def peak(graph):
            words = small_ffmpeg.command('-v', 'error', '-f', 'lavfi', '-i', f'testsrc2=size={size[0]}x{size[1]}',
                                         '-frames:v', '90', '-filter_threads', '1', '-lavfi', graph, '-f', 'null', '-')
            timed = subprocess.run(['/usr/bin/env', 'python3', '-c', PEAK, *words], env=small_ffmpeg.ENVIRONMENT,
                                   stdout=subprocess.PIPE, check=True)
            return int(timed.stdout) * 1024

        stabilizer = f'format=yuv420p,split[a][b];[b]l1l2stab=window={window}[c];'
        one = peak(f'format=yuv420p,l1l2stab=window={window}')
        two = peak(f'{stabilizer}[a][c]overlay=x=20')
        held = window * size[0] * size[1] * 3 // 2
        self.assertGreater(one, held)
        self.assertLess(two - one, held / 3)

    def test_interlaced_frames_are_reported_once(self):
        messages = run(*source, '-vf', f'setparams=field_mode=tff,l1l2stab=window={WINDOW}', '-f', 'null', '-')[1]
        self.assertEqual(messages.count('marked as interlaced'), 1)

    def test_wrong_settings_are_refused_with_the_reason(self):
        for graph, reason in {'l1l2stab=window=10:overlap=20': 'overlap', 'scale=8:8,l1l2stab': 'width',
                              'l1l2stab=lambda=-1': 'lambda', 'l1l2stab=region=left': 'x,y,width,height',
                              "l1l2stab=region='0,0,10,10'": 'region is', "l1l2stab=region='0,0,50%,2x'": '2x',
                              'l1l2stab=border=fill:output_size=crop': 'border=fill'}.items():
            with self.subTest(graph=graph):
                self.assertIn(reason, run(*source, '-vf', graph, '-f', 'null', '-', fails=True)[1])


PEAK = '''
import resource, subprocess, sys
subprocess.run(sys.argv[1:], check=True)
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
'''


class Changes(unittest.TestCase):
    """The size of the frames changes within the stream."""
    GRAPH = "scale=w='if(lt(n,25),320,240)':h='if(lt(n,25),240,180)':eval=frame,"

    def test_within_one_graph_the_held_frames_come_out_first(self):
        window = f'l1l2stab=window={WINDOW}'
        frames = filtered(f'{self.GRAPH}{window}')
        self.assertEqual(times(frames), [*range(FRAMES)])
        large = [f.bytes for f in frames].count(PICTURE)
        self.assertIn(large, (24, 25))  # the scaler counts from 1 in FFmpeg 7.1
        first = filtered(f'trim=end_frame={large},{window}')
        second = filtered(f'{self.GRAPH}trim=start_frame={large},{window}')
        self.assertEqual([f.bytes for f in frames], [f.bytes for f in first + second])
        self.assertEqual(md5s(frames), md5s(first + second))

    def test_a_scaler_after_it_brings_all_frames_to_one_size(self):
        frames = filtered(f'{self.GRAPH}l1l2stab=window={WINDOW},scale=160:120')
        self.assertEqual([(f.pts, f.bytes) for f in frames], [(i, 160 * 120 * 3 // 2) for i in range(FRAMES)])

    def test_other_pixel_aspects_start_another_path_and_no_frame_is_lost(self):
        frames = filtered(f'{self.GRAPH}setdar=4/3,l1l2stab=window={WINDOW}:output_size=crop')
        self.assertEqual(times(frames), [*range(FRAMES)])
        self.assertEqual({f.bytes for f in frames}, {288 * 216 * 3 // 2, 216 * 162 * 3 // 2})

    def test_the_ffmpeg_command_loses_held_frames_when_it_rebuilds_its_graph_unless_told_to_keep_it(self):
        # This is so with every filter that holds frames, such as FFmpeg's own reverse.
        path = folder / 'changing.h264'
        path.write_bytes(b''.join(encoded(w, h) for w, h in ((320, 240), (240, 180))))
        words = ['-i', path, '-fps_mode', 'passthrough', '-noautoscale']

        def count(graph, *before):
            return len(frames_of(*before, *words, '-vf', graph))

        self.assertEqual(count('null'), 2 * FRAMES)
        self.assertEqual(count('reverse'), FRAMES)
        self.assertEqual(count(f'l1l2stab=window={WINDOW}'), 2 * FRAMES - (WINDOW - 1))
        self.assertEqual(count(f'l1l2stab=window={WINDOW}', '-reinit_filter', '0'), 2 * FRAMES)


def encoded(width, height):
    """The film as an elementary stream of H.264 in another size."""
    raw = folder / 'scaled.yuv'
    run('-v', 'error', '-y', *source, '-vf', f'scale={width}:{height}', '-f', 'rawvideo', raw)
    path = folder / 'part.h264'
    clip.play(f'filesrc location={raw} ! rawvideoparse width={width} height={height} format=i420 framerate=30/1 ! '
              'x264enc speed-preset=superfast bframes=0 ! video/x-h264,stream-format=byte-stream ! '
              f'filesink location={path}')
    return path.read_bytes()


class Commands(unittest.TestCase):
    def commanded(self, commands):
        return filtered(f"sendcmd=c='{commands}',l1l2stab=window={WINDOW}")

    def setUp(self):
        self.plain = md5s(filtered(f'l1l2stab=window={WINDOW}'))

    def test_lambda_and_crop_ratio_apply_to_the_frames_that_come_in_after_the_command(self):
        for command in ('lambda 30', 'crop_ratio 0.7'):
            with self.subTest(command=command):
                made = md5s(self.commanded(f'1.0 l1l2stab {command}'))
                self.assertEqual(len(made), FRAMES)
                self.assertEqual(made[:30 - WINDOW], self.plain[:30 - WINDOW])
                self.assertNotIn(True, [a == b for a, b in zip(made[32:], self.plain[32:])])

    def test_a_command_before_the_first_frame_is_the_same_as_the_option(self):
        self.assertEqual(md5s(self.commanded('0 l1l2stab lambda 3')),
                         md5s(filtered(f'l1l2stab=window={WINDOW}:lambda=3')))

    def test_bypass_applies_to_the_frames_that_go_out_after_the_command(self):
        untouched = md5s(filtered('null'))
        made = md5s(filtered(f"l1l2stab=window={WINDOW},sendcmd=c='0.5 l1l2stab bypass 1'"))
        self.assertEqual(made[:15], self.plain[:15])
        self.assertEqual(made[15 + 31:], untouched[15 + 31:])
        self.assertNotEqual(made[20], untouched[20])

    def test_a_command_out_of_range_changes_nothing(self):
        self.assertEqual(md5s(self.commanded('1.0 l1l2stab lambda 5000; 1.0 l1l2stab window 20')), self.plain)


class Live(unittest.TestCase):
    def start(self, *words, to='pipe:1'):
        return subprocess.Popen(
            small_ffmpeg.command('-v', 'error', *small_ffmpeg.raw('pipe:0', WIDTH, HEIGHT), '-probesize', '32',
                                 *words, '-flush_packets', '1', '-f', 'rawvideo', to),
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=small_ffmpeg.ENVIRONMENT)

    def test_frames_of_a_pipe_come_out_while_it_is_open_with_the_delay_of_the_window(self):
        pictures = [*clip.pictures(FRAMES)]
        process = self.start('-vf', f'l1l2stab=window={WINDOW}')
        received, arrived = bytearray(), threading.Condition()

        def read():
            while data := process.stdout.read1(1 << 20):
                with arrived:
                    received.extend(data)
                    arrived.notify()

        reader = threading.Thread(target=read)
        reader.start()
        process.stdin.write(b''.join(pictures[:9 + WINDOW + 3]))  # demuxer, decoder and encoder hold a frame each
        process.stdin.flush()
        with arrived:
            self.assertTrue(arrived.wait_for(lambda: len(received) >= 10 * PICTURE, 30))
            self.assertLessEqual(len(received), (9 + 3 + 1) * PICTURE)
        self.assertIsNone(process.poll())
        process.stdin.write(b''.join(pictures[9 + WINDOW + 3:]))
        process.stdin.close()
        reader.join(30)
        self.assertEqual(process.wait(30), 0)
        self.assertEqual(len(received), FRAMES * PICTURE)

    def threads_of(self, graph, count):
        """How many threads ffmpeg has while frames come out."""
        out = folder / 'live.yuv'
        out.unlink(missing_ok=True)
        process = self.start('-threads', '1', '-filter_threads', count, '-vf', graph, to=out)
        process.stdin.write(film.read_bytes())
        process.stdin.flush()
        end = time.monotonic() + 30
        while not (out.exists() and out.stat().st_size) and time.monotonic() < end:
            time.sleep(0.01)
        threads = len(os.listdir(f'/proc/{process.pid}/task'))
        process.communicate(timeout=30)
        self.assertEqual(out.stat().st_size, FRAMES * PICTURE)
        return threads

    def test_the_number_of_threads_is_that_of_filter_threads(self):
        for count in (1, 2, 4):
            with self.subTest(threads=count):
                own = self.threads_of(f'l1l2stab=window={WINDOW}', count) - self.threads_of('null', count)
                self.assertEqual(own, count - 1)
        own = self.threads_of(f'l1l2stab=window={WINDOW}:threads=2', 4) - self.threads_of('null', 4)
        self.assertEqual(own, 1)

    def test_the_frames_do_not_depend_on_the_number_of_threads(self):
        graph = f'l1l2stab=window={WINDOW}'
        self.assertEqual(md5s(filtered(graph, '-filter_threads', '1')), md5s(filtered(graph, '-filter_threads', '4')))


if __name__ == '__main__':
    unittest.main(verbosity=2)
