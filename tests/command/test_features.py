#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""What l1l2stab can do besides one file in and one out: parts, comparison, motion files, estimates, batches; and that
the manual page and the shells know all options.

test_features.py L1L2STAB SOURCE_DIR
"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

import case
import kinds
import probe
from case import L1L2STAB

SOURCE = Path(sys.argv[2]) / 'samples/l1l2stab'


class Case(case.FolderEach):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.clip = cls.stock / 'clip.mp4'
        kinds.ffmpeg(*kinds.video(seconds=3), *kinds.tone(seconds=3), *kinds.H264, '-g', '20', '-bf', '2',
                     *kinds.AAC, cls.clip)

    def picture(self, path, number=0):
        """A frame as rows of gray pixels."""
        raw = subprocess.run(['ffmpeg', '-v', 'quiet', '-i', str(path), '-vf', f'select=eq(n\\,{number}),format=gray',
                              '-frames:v', '1', '-f', 'rawvideo', '-'], stdout=subprocess.PIPE, check=True).stdout
        width = probe.File(path).video['width']
        return [raw[i:i + width] for i in range(0, len(raw), width)]


class Parts(Case):
    def test_a_part_begins_and_ends_where_it_is_told(self):
        self.run_command(self.clip, '--start=0.9', '--end=0:02', '-o', 'a.mp4')
        part, whole = probe.File(self.path / 'a.mp4'), probe.File(self.clip)
        self.assertEqual(len(part.frames), sum(0.9 <= t - whole.times[0] < 2 for t in whole.times))
        self.assertAlmostEqual(part.times[0], 0, delta=0.045)
        sound = part.audio_packets(0)
        self.assertAlmostEqual(float(sound[0]['pts_time']), 0, delta=0.03)
        self.assertAlmostEqual(float(sound[-1]['pts_time']), 1.1, delta=0.06)

    def test_chapters_are_cut_with_the_film(self):
        kinds.rich('mov_text')(self.path / 'rich.mp4')
        self.run_command('rich.mp4', '--start=1', '-o', 'a.mp4')
        self.assertEqual(probe.File(self.path / 'a.mp4').chapters, [(0.0, 0.6, 'two')])

    def test_a_start_behind_the_end_is_an_error(self):
        run = self.run_command(self.clip, '--start=50', '-o', 'a.mp4', code=3)
        self.assertIn('no frame', run.stderr)


class WholeFrames(Case):
    def test_a_filled_border_keeps_the_scale_and_a_cropped_one_enlarges(self):
        """The film pans over a pattern: its detail is as fine as before if the frame is shown whole."""
        def detail(path):
            rows = self.picture(path, 30)
            return sum(abs(a - b) for row in rows for a, b in zip(row, row[1:]))
        for border in ('fill', 'crop'):
            self.run_command(self.clip, '--border', border, '--crop-ratio=0.75', '--report=report', '-o',
                             f'{border}.mp4')
        fill, crop = (json.loads((self.path / 'report' / f'{name}.json').read_text()) for name in ('fill', 'crop'))
        self.assertTrue(fill['whole'] and not crop['whole'])
        self.assertEqual(crop['filled-mean'] + crop['extended-mean'], 0)
        self.assertEqual(len(probe.File(self.path / 'fill.mp4').frames), len(probe.File(self.clip).frames))
        self.assertGreater(detail(self.path / 'fill.mp4'), 1.1 * detail(self.path / 'crop.mp4'))

    def test_a_whole_frame_cannot_have_the_crop_windows_size(self):
        run = self.run_command(self.clip, '--border=fill', '--output-size=crop', '-o', 'a.mp4', code=2)
        self.assertIn('border=fill', run.stderr)
        run = self.run_command(self.clip, '--window=10', '--overlap=20', '-o', 'a.mp4', code=2)
        self.assertIn('overlap is 20', run.stderr)


class Comparison(Case):
    def test_side_shows_the_source_on_the_left(self):
        self.run_command(self.clip, '--compare=side', '--encoder=ffv1', '-o', 'side.mkv')
        side = probe.File(self.path / 'side.mkv')
        self.assertEqual((side.video['width'], side.video['height'], len(side.frames)), (640, 240, 75))
        source, both = self.picture(self.clip, 30), self.picture(self.path / 'side.mkv', 30)
        self.assertEqual([row[:320] for row in both], source)
        self.assertNotEqual([row[320:] for row in both], source)

    def test_split_shows_half_of_each_and_flip_both_in_turn(self):
        for kind in ('split', 'flip'):
            self.run_command(self.clip, f'--compare={kind}', '--encoder=ffv1', '-o', f'{kind}.mkv')
        self.run_command(self.clip, '--encoder=ffv1', '-o', 'plain.mkv')
        source, plain = self.picture(self.clip, 30), self.picture(self.path / 'plain.mkv', 30)
        split = self.picture(self.path / 'split.mkv', 30)
        self.assertEqual([row[:160] for row in split], [row[:160] for row in source])
        self.assertEqual([row[160:] for row in split], [row[160:] for row in plain])
        self.assertEqual(self.picture(self.path / 'flip.mkv', 3), self.picture(self.clip, 3))
        self.assertEqual(self.picture(self.path / 'flip.mkv', 30), plain)

    def test_ten_bits_can_be_compared(self):
        kinds.simple(*kinds.HDR10, sound=False)(self.path / 'hdr.mkv')
        self.run_command('hdr.mkv', '--compare=side', '-o', 'side.mkv')
        side = probe.File(self.path / 'side.mkv')
        self.assertEqual((side.video['width'], side.depth()), (640, 10))

    def test_a_preview_without_a_display_is_refused(self):
        environment = {key: value for key, value in os.environ.items() if key not in ('DISPLAY', 'WAYLAND_DISPLAY')}
        run = subprocess.run([L1L2STAB, '--preview', self.clip], env=environment, stderr=subprocess.PIPE, timeout=30)
        self.assertEqual((run.returncode, run.stderr.count(b'\n')), (1, 1))


class Motion(Case):
    def test_a_second_run_reads_the_motion_of_the_first(self):
        common = ('--rolling-shutter=none', '--encoder=ffv1')
        self.run_command(self.clip, *common, '--motion-out=a.motion', '-o', 'a.mkv')
        self.run_command(self.clip, *common, '--motion-in=a.motion', '-o', 'b.mkv')
        self.assertEqual(self.picture(self.path / 'a.mkv', 40), self.picture(self.path / 'b.mkv', 40))
        run = self.run_command(self.clip, '--motion-in=absent', '-o', 'c.mkv', code=1)
        self.assertIn('absent', run.stderr)

    def test_an_estimate_says_how_shaky_and_what_each_crop_leaves(self):
        run = self.run_command('--estimate', '--json', self.clip)
        estimate = json.loads(run.stdout.splitlines()[-1])
        self.assertEqual((estimate['type'], estimate['frames']), ('estimate', 75))
        self.assertGreater(estimate['shake'], 4)
        left = [crop['left'] for crop in estimate['crops']]
        self.assertEqual(len(left), 7)
        self.assertLess(left[-1], 0.3)
        self.assertLessEqual(left[-1], left[0])
        self.assertEqual(os.listdir(self.path), [])
        text = self.run_command('--estimate', self.clip).stdout
        self.assertIn('--crop-ratio', text)

    def test_a_steady_film_has_no_shake(self):
        still = self.path / 'still.mp4'
        kinds.ffmpeg('-f', 'lavfi', '-i', 'mandelbrot=s=320x240:r=25,trim=end_frame=1,loop=50:1:0', '-t', '2',
                     *kinds.H264, still)
        estimate = json.loads(self.run_command('--estimate', '--json', still).stdout.splitlines()[-1])
        self.assertLess(estimate['shake'], 0.1)
        self.assertEqual(estimate['degree'], 'steady')

    def test_crop_auto_takes_less_where_less_is_kept(self):
        ratios = []
        for keep in ('0.999', '0.3'):
            run = self.run_command(self.clip, '--crop=auto', f'--keep={keep}', '-o', 'a.mp4')
            ratios.append(float(re.search(r'crop-ratio ([0-9.]+) keeps', run.stderr)[1]))
        self.assertLessEqual(ratios[0], ratios[1])
        self.assertEqual(ratios[1], 0.98)


class Batch(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.tiny = cls.stock / 'tiny.mp4'
        kinds.ffmpeg(*kinds.video(96, 96, seconds=0.4), *kinds.H264, cls.tiny)

    def fill(self, count, broken=()):
        (self.path / 'in').mkdir()
        for number in range(count):
            target = self.path / f'in/f{number:02}.mp4'
            target.write_bytes(b'broken' if number in broken else self.tiny.read_bytes())

    def outputs(self):
        return sorted(os.listdir(self.path / 'out'))

    def test_broken_files_are_named_and_the_others_are_done(self):
        self.fill(12, broken=(3, 7))
        run = self.run_command('--batch', 'in', '--out-dir=out', '-j2', code=7)
        self.assertIn('12 files: 10 done, 2 failed: in/f03.mp4, in/f07.mp4', run.stderr)
        self.assertEqual(len(self.outputs()), 10)
        again = self.run_command('--batch', 'in', '--out-dir=out', '--skip-existing', '--json', code=7)
        summary = json.loads(again.stdout.splitlines()[-1])
        self.assertEqual((summary['done'], summary['skipped'], summary['failed']), (0, 10, ['in/f03.mp4',
                                                                                            'in/f07.mp4']))

    def test_a_killed_batch_goes_on_where_it_was(self):
        self.fill(16)
        process = subprocess.Popen([L1L2STAB, '--batch', 'in', '--out-dir=out', '-j2', '-q'], cwd=self.path)
        for _ in range(600):
            if (self.path / 'out').is_dir() and len(self.outputs()) >= 3:
                break
            time.sleep(0.05)
        process.kill()
        process.wait()
        time.sleep(1)  # the processes of its files end with it
        before = {name: (self.path / 'out' / name).stat().st_mtime_ns for name in self.outputs()}
        self.assertGreaterEqual(len(before), 3)
        self.assertLess(len(before), 16)
        self.assertTrue(all(name.endswith('-stabilized.mp4') for name in before), before)
        self.run_command('--batch', 'in', '--out-dir=out', '-j2', '--skip-existing')
        self.assertEqual(len(self.outputs()), 16)
        for name, changed in before.items():
            self.assertEqual((self.path / 'out' / name).stat().st_mtime_ns, changed, f'{name} was made twice')

    def test_an_interrupt_ends_all_processes(self):
        shutil.copy(self.clip, self.path / 'a.mp4')
        shutil.copy(self.clip, self.path / 'b.mp4')
        slow = ('--interpolation=lanczos', '--window=20', '--overlap=19')
        process = subprocess.Popen([L1L2STAB, *slow, '-j2', '--json', 'a.mp4', 'b.mp4', '--out-dir=out'], cwd=self.path,
                                   stdout=subprocess.PIPE)
        process.stdout.readline()
        process.send_signal(signal.SIGTERM)
        process.stdout.read()
        process.stdout.close()
        self.assertEqual(process.wait(timeout=30), 143)
        self.assertEqual(self.outputs(), [])

    def test_names_follow_the_options_and_never_collide(self):
        for folder in ('x', 'y'):
            (self.path / folder).mkdir()
            shutil.copy(self.tiny, self.path / folder / 'a.mp4')
        run = self.run_command('x/a.mp4', 'y/a.mp4', '--out-dir=out', '--suffix=_s', '--format=mkv', code=7)
        self.assertEqual(self.outputs(), ['a_s.mkv'])
        self.assertIn('y/a.mp4: its output would replace that of x/a.mp4', run.stderr)

    def test_its_own_outputs_are_not_stabilized_again(self):
        shutil.copy(self.tiny, self.path / 'a.mp4')
        shutil.copy(self.tiny, self.path / 'b.mp4')
        for _ in range(2):
            self.run_command('--batch', '.')
        self.assertEqual(sorted(os.listdir(self.path)), ['a-stabilized.mp4', 'a.mp4', 'b-stabilized.mp4', 'b.mp4'])

    def test_options_reach_each_file(self):
        shutil.copy(self.tiny, self.path / 'a.mp4')
        shutil.copy(self.tiny, self.path / 'b.mp4')
        self.run_command('a.mp4', 'b.mp4', '--out-dir=out', '--encoder=ffv1', '--format=mkv', '--start=0.2',
                         '--lambda', '1')
        for name in self.outputs():
            result = probe.File(self.path / 'out' / name)
            self.assertEqual((result.video['codec_name'], len(result.frames)), ('ffv1', 5))


class Documents(Case):
    def options(self):
        lines = self.run_command('--complete').stdout.splitlines()
        return [line.split(' ')[0] for line in lines]

    def test_the_manual_page_has_every_option_of_the_program(self):
        page = (SOURCE / 'l1l2stab.1').read_text()
        elements_own = ('--bypass', '--overlap', '--join', '--motion-model', '--rolling-shutter', '--interpolation',
                        '--output-size', '--threads', '--complete')
        for option in self.options():
            if option not in elements_own:
                self.assertIn('Fl -' + option[2:], page, option)

    def test_the_manual_page_has_every_exit_code(self):
        codes = re.findall(r'EXIT_\w+ = (\d+)', (SOURCE / 'fault.h').read_text())
        page = (SOURCE / 'l1l2stab.1').read_text()
        for code in codes:
            if int(code) < 128:
                self.assertRegex(page, rf'\.It {code}\n')

    @unittest.skipUnless(shutil.which('mandoc'), 'mandoc is not installed')
    def test_the_manual_page_has_no_faults(self):
        run = subprocess.run(['mandoc', '-T', 'lint', '-W', 'style', SOURCE / 'l1l2stab.1'], stdout=subprocess.PIPE,
                             encoding='utf-8')
        faults = [line for line in run.stdout.splitlines()
                  if 'outdated' not in line and 'referenced manual' not in line]
        self.assertEqual(faults, [])

    def shell(self, *command):
        environment = {**os.environ, 'PATH': f'{Path(L1L2STAB).parent}:{os.environ["PATH"]}'}
        return subprocess.run(command, stdout=subprocess.PIPE, env=environment, cwd=self.path, timeout=60,
                              encoding='utf-8',
                              check=True).stdout.split()

    def test_bash_completes_options_values_and_names(self):
        (self.path / 'film.mp4').touch()
        script = SOURCE / 'completion/l1l2stab.bash'

        def complete(*words):
            return self.shell('bash', '-c', f'. {script}; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _l1l2stab; '
                              'printf "%s\\n" "${COMPREPLY[@]}"', 'bash', 'l1l2stab', *words)
        self.assertEqual(complete('--crop-'), ['--crop-ratio'])
        self.assertEqual(complete('--compare', 's'), ['side', 'split'])
        self.assertEqual(complete('--join', '=', 'b'), ['blend'])
        self.assertEqual(complete('fi'), ['film.mp4'])
        self.assertEqual(complete('--output', 'fi'), ['film.mp4'])

    @unittest.skipUnless(shutil.which('fish'), 'fish is not installed')
    def test_fish_completes_options_and_values(self):
        script = SOURCE / 'completion/l1l2stab.fish'
        environment = f'set -x HOME {self.path}; source {script}; '
        self.assertEqual(self.shell('fish', '-c', environment + 'complete -C "l1l2stab --compare s"'), ['side',
                                                                                                        'split'])
        self.assertIn('--crop-ratio', self.shell('fish', '-c', environment + 'complete -C "l1l2stab --crop"'))

    @unittest.skipUnless(shutil.which('zsh'), 'zsh is not installed')
    def test_zsh_reads_its_file(self):
        self.assertEqual(self.shell('zsh', '-f', '-n', SOURCE / 'completion/_l1l2stab'), [])


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
