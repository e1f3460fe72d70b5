#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Wrong arguments, broken files, full disks and signals: l1l2stab says in one line what is wrong, and destroys nothing.

test_faults.py L1L2STAB
"""
import json
import os
import signal
import subprocess
import sys
import threading
import unittest
from pathlib import Path

import case
import kinds
import probe
from case import L1L2STAB

SLOW = ('--interpolation=lanczos', '--window=20', '--overlap=19')


class Case(case.FolderEach):
    """Each test has a clip, and an empty folder `out` for outputs."""
    timeout = 100

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clip = cls.stock / 'clip.mp4'
        kinds.simple(*kinds.H264, *kinds.AAC)(cls.clip)

    def setUp(self):
        super().setUp()
        self.out = self.path / 'out'
        self.out.mkdir()

    def run_command(self, *arguments, code=None, **options):
        return super().run_command(*arguments, code=code, **options)

    def refuses(self, code, words, *arguments, **options):
        """It ends with this exit code, one line with these words, and no file in out."""
        run = self.run_command(*arguments, **options)
        self.assertEqual(run.returncode, code, run.stderr)
        self.assertIn(words, run.stderr)
        self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
        self.assertEqual(os.listdir(self.out), [])

    def copy(self, name='clip.mp4'):
        path = self.path / name
        path.write_bytes(self.clip.read_bytes())
        return path


class Inputs(Case):
    def test_a_missing_file_a_folder_and_an_empty_file_are_named(self):
        (self.path / 'empty.mp4').touch()
        self.refuses(3, 'absent.mp4: no such file', 'absent.mp4', '-o', 'out/a.mp4')
        self.refuses(3, 'is a folder', '.', '-o', 'out/a.mp4')
        self.refuses(3, 'is not a video', 'empty.mp4', '-o', 'out/a.mp4')

    def test_text_sound_and_a_picture_are_no_videos(self):
        (self.path / 'text.mp4').write_text('this is no video\n')
        (self.path / 'noise.mp4').write_bytes(os.urandom(100000))
        kinds.ffmpeg(*kinds.tone(), self.path / 'sound.m4a')
        kinds.ffmpeg('-f', 'lavfi', '-i', 'color=red:s=99x99', '-frames:v', '1', self.path / 'picture.png')
        self.refuses(3, 'is not a video', 'text.mp4', '-o', 'out/a.mp4')
        self.refuses(3, 'is not a video', 'noise.mp4', '-o', 'out/a.mp4')
        self.refuses(3, 'has sound only', 'sound.m4a', '-o', 'out/a.mp4')
        self.refuses(3, 'is a picture', 'picture.png', '-o', 'out/a.mp4')

    def test_a_file_without_its_index_is_called_truncated(self):
        (self.path / 'cut.mp4').write_bytes(self.clip.read_bytes()[:20000])
        self.refuses(3, 'is truncated', 'cut.mp4', '-o', 'out/a.mp4')

    def test_a_truncated_matroska_file_gives_what_can_be_read_and_says_so(self):
        whole = self.path / 'whole.mkv'
        kinds.simple(*kinds.H264, *kinds.AAC)(whole)
        (self.path / 'cut.mkv').write_bytes(whole.read_bytes()[:-9000])
        run = self.run_command('cut.mkv', '-o', 'out/a.mkv')
        self.assertEqual(run.returncode, 6, run.stderr)
        self.assertIn('truncated or damaged', run.stderr)
        self.assertGreater(len(probe.File(self.out / 'a.mkv').frames), 10)

    def test_a_file_that_ends_before_its_sound_begins_keeps_the_picture(self):
        kinds.ffmpeg(*kinds.video(), '-itsoffset', '1.2', *kinds.tone(), *kinds.H264, *kinds.AAC,
                     self.path / 'whole.ts')
        whole = (self.path / 'whole.ts').read_bytes()
        (self.path / 'cut.ts').write_bytes(whole[:len(whole) // 2])
        run = self.run_command('cut.ts', '-o', 'out/a.ts')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('audio stream 1 is left out', run.stderr)
        self.assertGreater(len(probe.File(self.out / 'a.ts').frames), 10)

    def test_pixels_that_no_camera_has_are_taken_for_square(self):
        for aspect in '1/257', '500/1':
            damaged, steady = self.path / 'damaged.avi', self.out / 'steady.mkv'
            kinds.ffmpeg(*kinds.video(96, 64, 25, 0.6), '-vf', f'setsar={aspect}', '-c:v', 'mpeg4', damaged)
            run = self.run_command(damaged.name, '-o', 'out/steady.mkv', '--window=6', code=0)
            self.assertIn('they are taken for square', run.stderr)
            stream = probe.ffprobe(steady, '-show_streams', '-count_frames')['streams'][0]
            self.assertEqual((stream['sample_aspect_ratio'], stream['nb_read_frames']), ('1:1', '15'))
            damaged.unlink()
            steady.unlink()

    def test_an_encrypted_file_is_named(self):
        kinds.ffmpeg('-i', self.clip, '-c', 'copy', '-encryption_scheme', 'cenc-aes-ctr', '-encryption_key', '0' * 32,
                     '-encryption_kid', '1' * 32, self.path / 'secret.mp4')
        self.refuses(3, 'encrypted', 'secret.mp4', '-o', 'out/a.mp4')

    def test_a_missing_decoder_is_named_with_its_package(self):
        ranks = ','.join(f'{name}:NONE' for name in ('avdec_h264', 'openh264dec', 'vah264dec', 'vaapih264dec',
                                                     'nvh264dec',
                                                     'v4l2h264dec', 'v4l2slh264dec'))
        self.refuses(5, 'gstreamer1.0-libav', self.clip, '-o', 'out/a.mp4',
                     env={**os.environ, 'GST_PLUGIN_FEATURE_RANK': ranks})

    def test_a_stream_that_is_no_video_is_refused(self):
        self.refuses(2, 'stream 1 is not a video stream', self.clip, '--stream=1', '-o', 'out/a.mp4')
        self.refuses(2, 'stream 9 is not a video stream', self.clip, '--stream=9', '-o', 'out/a.mp4')

    def test_the_stream_that_is_asked_for_is_stabilized(self):
        kinds.two_videos(self.path / 'two.mkv')
        run = self.run_command('two.mkv', '--stream=1', '--encoder=ffv1', '-o', 'out/a.mkv')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual([s['codec_name'] for s in probe.File(self.out / 'a.mkv').of_type('video')], ['h264', 'ffv1'])


class Outputs(Case):
    def test_the_output_is_never_the_input(self):
        clip = self.copy('a clip.mp4')
        (self.path / 'symbolic.mp4').symlink_to('a clip.mp4')
        (self.path / 'hard.mp4').hardlink_to(clip)
        for name in ('a clip.mp4', str(clip), './out/../a clip.mp4', 'symbolic.mp4', 'hard.mp4'):
            self.refuses(2, 'is the input too', 'a clip.mp4', '-o', name)
        self.assertEqual(clip.read_bytes(), self.clip.read_bytes())

    def test_names_that_cannot_be_written_are_named(self):
        (self.path / 'folder.mp4').mkdir()
        self.refuses(2, 'has to end with', self.clip, '-o', 'out/a.xyz')
        self.refuses(2, 'has to end with', self.clip, '-o', 'out/mp4')
        self.refuses(4, 'absent/a.mp4: cannot be written: No such file', self.clip, '-o', 'absent/a.mp4')
        self.refuses(4, 'not a regular file', self.clip, '-o', 'folder.mp4')
        self.refuses(4, '/proc/a.mp4: cannot be written', self.clip, '-o', '/proc/a.mp4')

    def test_a_full_disk_is_named_and_leaves_nothing(self):
        script = ('mount -t tmpfs -o size=40k none "$1" || exit 77; "$2" "$3" -o "$1/a.mp4"; code=$?; ls -A "$1" >&2; '
                  'exit $code')
        run = subprocess.run(['unshare', '--map-root-user', '--mount', 'sh', '-c', script, 'sh', self.out, L1L2STAB,
                              self.clip], stderr=subprocess.PIPE, encoding='utf-8', timeout=100)
        if run.returncode in (1, 77) and 'a.mp4' not in run.stderr:
            self.skipTest('no small file system can be mounted here: ' + run.stderr)
        self.assertEqual(run.returncode, 4, run.stderr)
        self.assertEqual(run.stderr.split('\n', 1)[1], '', 'a file is left')
        self.assertIn('a.mp4: the disk is full', run.stderr)

    def test_codecs_that_a_container_does_not_take_are_refused(self):
        self.refuses(2, '.webm does not take h264', self.clip, '--encoder=h264', '-o', 'out/a.webm')

    def test_an_old_output_is_replaced_and_has_the_usual_permissions(self):
        (self.out / 'a.mp4').write_text('old')
        run = self.run_command(self.clip, '-o', 'out/a.mp4')
        self.assertEqual(run.returncode, 0, run.stderr)
        (self.path / 'plain').touch()
        self.assertEqual((self.out / 'a.mp4').stat().st_mode, (self.path / 'plain').stat().st_mode)
        self.assertEqual(len(probe.File(self.out / 'a.mp4').frames), 40)

    def test_a_failed_rename_leaves_nothing(self):
        process = subprocess.Popen([L1L2STAB, self.clip, *SLOW, '-o', self.out / 'a.mp4'], stderr=subprocess.PIPE)
        (self.out / 'a.mp4').mkdir()
        said = process.communicate(timeout=100)[1].decode()
        self.assertEqual(process.returncode, 4, said)
        self.assertEqual(os.listdir(self.out), ['a.mp4'])


class Arguments(Case):
    def test_wrong_options_are_named(self):
        for words, *arguments in (
                ('out of range', '--crop-ratio=3'), ('not a valid value', '--lambda=much'), ('no option --novelty',
                                                                                             '--novelty=1'),
                ('no option -z', '-z'), ('its value is missing', '--crf'), ('not a number', '--crf=good'),
                ('exclude each other', '--crf=20', '--bitrate=900'), ('not a time', '--start=soon'),
                ('later than --start', '--start=2', '--end=1'), ('is not side', '--compare=up'),
                ('takes no value', '--quiet=1'), ('no encoder', '--encoder=nothing'), ('key=value',
                                                                                       '--encoder=h264:fast'),
                ('no property', '--encoder=h264:novelty=1'), ('not a valid value', '--encoder=h264:bframes=many'),
                ('not a preset', '--preset=a!b'), ('--crf: ffv1 has none', '--encoder=ffv1', '--crf=3')):
            name = 'out/a.mkv' if '--encoder=ffv1' in arguments else 'out/a.mp4'
            self.refuses(2, words, self.clip, '-o', name, *arguments)
        self.refuses(2, 'no input')
        self.refuses(2, 'several inputs', self.clip, self.clip, '-o', 'out/a.mp4')

    def test_names_may_have_any_bytes(self):
        for name in ('with space.mp4', 'quote\'s "q".mp4', 'two\nlines.mp4', b'\xff\xfe\x01.mp4', 'http:x.mp4',
                     '%d%s.mp4'):
            name = os.fsencode(name)
            path = os.fsencode(self.path) + b'/' + name
            Path(os.fsdecode(path)).write_bytes(self.clip.read_bytes())
            run = self.run_command(name, b'-o', b'out/' + name)
            self.assertEqual(run.returncode, 0, (name, run.stderr))
            self.assertEqual(run.stderr.count('\n'), 1, run.stderr)
            self.assertIn(name, os.listdir(os.fsencode(self.out)))

    def test_a_leading_dash_is_a_name_behind_two_dashes(self):
        self.copy('-lambda.mp4')
        run = self.run_command('-o', 'out/a.mp4', '--', '-lambda.mp4')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.refuses_name_with_dash()

    def refuses_name_with_dash(self):
        run = self.run_command('-lambda.mp4', '-o', 'out/b.mp4')
        self.assertEqual(run.returncode, 2)
        self.assertIn('./-lambda.mp4', run.stderr)

    def test_help_fits_a_screen_and_names_each_property(self):
        run = self.run_command('--help')
        self.assertEqual(run.returncode, 0)
        lines = run.stdout.splitlines()
        self.assertLessEqual(len(lines), 24)
        self.assertLessEqual(max(map(len, lines)), 80)
        for name in ('lambda', 'crop-ratio', 'window', 'motion-out'):
            self.assertIn(f'--{name} ', run.stdout)
        self.assertEqual(run.stderr, '')

    def test_quiet_says_nothing_and_json_says_it_in_objects(self):
        run = self.run_command(self.clip, '--quiet', '-o', 'out/a.mp4')
        self.assertEqual((run.returncode, run.stdout, run.stderr), (0, '', ''))
        run = self.run_command(self.clip, '--json', '-o', 'out/b.mp4')
        self.assertEqual((run.returncode, run.stderr), (0, ''))
        objects = [json.loads(line) for line in run.stdout.splitlines()]
        result = objects[-1]
        self.assertEqual((result['type'], result['frames'], result['exit'], result['output']), ('result', 40, 0,
                                                                                                'out/b.mp4'))
        self.assertEqual(result['bytes'], (self.out / 'b.mp4').stat().st_size)

    def test_errors_are_json_too(self):
        run = self.run_command('--json', 'absent.mp4', '-o', 'out/a.mp4')
        self.assertEqual(run.returncode, 3)
        self.assertEqual(json.loads(run.stdout)['type'], 'error')


class Signals(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.long = cls.stock / 'long.mp4'
        kinds.ffmpeg(*kinds.video(seconds=20), *kinds.tone(seconds=20), *kinds.H264, *kinds.AAC, cls.long)

    def start(self, *arguments, source=None):
        """Starts a run that takes long, and waits until it has written frames."""
        # A test that runs under nohup would pass on that SIGHUP is ignored.
        process = subprocess.Popen(['env', '--default-signal=HUP', L1L2STAB, source or self.long, *SLOW, '--json',
                                    *arguments,
                                    '-o', self.out / 'a.mp4'], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                   encoding='utf-8')
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        return process

    def wait_for_progress(self, process):
        for line in process.stdout:
            if json.loads(line)['type'] == 'progress':
                return
        self.fail('no progress: ' + process.stderr.read())

    def end(self, process):
        threading.Thread(target=process.stdout.read).start()
        return process.wait(timeout=60)

    def test_the_first_interrupt_leaves_a_playable_file_up_to_there(self):
        process = self.start()
        self.wait_for_progress(process)
        process.send_signal(signal.SIGINT)
        self.assertEqual(self.end(process), 130)
        self.assertEqual(os.listdir(self.out), ['a.partial.mp4'])
        part = probe.File(self.out / 'a.partial.mp4')
        self.assertGreater(len(part.frames), 20)
        self.assertLess(len(part.frames), 500)
        packets = part.audio_packets(0)
        self.assertAlmostEqual(float(packets[-1]['pts_time']), part.times[-1], delta=0.1)

    def test_a_second_interrupt_ends_it_at_once(self):
        process = self.start()
        self.wait_for_progress(process)
        process.send_signal(signal.SIGINT)
        process.send_signal(signal.SIGINT)
        code = self.end(process)
        self.assertEqual(code, 130)
        self.assertIn(os.listdir(self.out), ([], ['a.partial.mp4']))

    def test_other_signals_end_it_at_once_and_leave_nothing(self):
        for number in (signal.SIGTERM, signal.SIGHUP):
            process = self.start()
            self.wait_for_progress(process)
            process.send_signal(number)
            self.assertEqual(self.end(process), 128 + number)
            self.assertEqual(os.listdir(self.out), [])

    def test_even_killing_it_leaves_nothing(self):
        process = self.start()
        self.wait_for_progress(process)
        process.kill()
        self.end(process)
        self.assertEqual(os.listdir(self.out), [])

    def test_a_closed_pipe_does_not_end_it(self):
        process = self.start(source=self.clip)
        process.send_signal(signal.SIGCONT)
        process.stdout.close()
        self.assertEqual(process.wait(timeout=60), 0)
        self.assertEqual(os.listdir(self.out), ['a.mp4'])

    def test_a_fifo_can_be_read_and_can_be_interrupted_while_nobody_writes(self):
        fifo = self.path / 'fifo'
        os.mkfifo(fifo)
        process = self.start(source=fifo)
        with self.assertRaises(subprocess.TimeoutExpired):
            process.wait(timeout=1)
        process.send_signal(signal.SIGTERM)
        self.assertIn(self.end(process), (-signal.SIGTERM, 128 + signal.SIGTERM))

        whole = self.path / 'whole.mkv'
        kinds.simple(*kinds.H264, *kinds.AAC)(whole)
        process = self.start(source=fifo)
        fifo.write_bytes(whole.read_bytes())
        self.assertEqual(self.end(process), 0)
        self.assertEqual(len(probe.File(self.out / 'a.mp4').frames), 40)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
