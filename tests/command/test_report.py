#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The report of l1l2stab: its numbers against those of --estimate, and its page in Chromium, where that is installed.

test_report.py L1L2STAB          SCREENSHOTS=folder keeps pictures of the page at the widths of a phone and a desktop
"""
import csv
import html
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import case
import kinds
from case import L1L2STAB

CHROMIUM = shutil.which('chromium')
SKIP = 77  # for meson
PHONE, DESKTOP = 390, 1280  # pixels
# A name that must not end a script or a string of the page.
NAME = 'a<b> "c" \'d\' </script>\u00e4.mp4'.replace('/', '_')

# Runs in the page behind its own script. It does what a user does, and leaves in the document what came of it.
ACTIONS = '''
<script>
const result = { ready: document.documentElement.dataset.ready, title: document.title };
/* --dump-dom paints nothing, so there are no animation frames. */
window.requestAnimationFrame = done => setTimeout(done, 16);
const settle = () => new Promise(done => setTimeout(done, 100));
const width = () => +(range.to - range.from).toFixed(3);
const box = byId('charts').firstElementChild, area = box.getBoundingClientRect();
const pointer = (type, id, x, kind) => box.dispatchEvent(new PointerEvent(type,
  { pointerId: id, pointerType: kind, clientX: area.left + x * area.width, bubbles: true, buttons: 1 }));
box.setPointerCapture = () => {};
(async () => {
  await settle();
  result.whole = width();
  byId('closer').click(); await settle(); result.button = width();
  byId('all').click(); await settle();
  box.dispatchEvent(new WheelEvent('wheel', { deltaY: -1, clientX: area.left + area.width / 2, cancelable: true }));
  await settle(); result.wheel = width();
  byId('all').click(); await settle();
  pointer('pointerdown', 1, 0.4, 'mouse'); pointer('pointermove', 1, 0.6, 'mouse');
  pointer('pointerup', 1, 0.6, 'mouse');
  await settle(); result.drag = width(); result.points = charts[0].data.datasets[0].data.length;
  byId('all').click(); await settle();
  pointer('pointerdown', 1, 0.4, 'touch'); pointer('pointerdown', 2, 0.6, 'touch');
  pointer('pointermove', 1, 0.2, 'touch'); pointer('pointermove', 2, 0.8, 'touch');
  pointer('pointerup', 1, 0.2, 'touch'); pointer('pointerup', 2, 0.8, 'touch');
  await settle(); result.pinch = width();
  const canvas = byId('pair'), copy = new OffscreenCanvas(canvas.width, canvas.height);
  const context = copy.getContext('2d', { willReadFrequently: true });
  const slide = value => {
    byId('slider').value = value;
    byId('slider').oninput();
    context.drawImage(canvas, 0, 0);
    return context.getImageData(0, 0, canvas.width, canvas.height).data;
  };
  const before = slide(1000), after = slide(0);
  result.changed = before.some((value, i) => value !== after[i]);
  result.pair = [canvas.width, canvas.height];
  /* The mean of the upper left quarter against that of the lower right one tells how the picture is turned. */
  const mean = (data, left, top) => { let sum = 0, count = 0;
    for (let y = top; y < top + canvas.height / 2; y += 2) for (let x = left; x < left + canvas.width / 2; x += 2) {
      sum += data[4 * (Math.floor(y) * canvas.width + Math.floor(x))]; count++; }
    return sum / count; };
  result.quarters = [[0, 0], [0.5, 0], [0, 0.5], [0.5, 0.5]].map(([x, y]) =>
    mean(before, x * canvas.width, y * canvas.height));
  result.overflow = document.documentElement.scrollWidth > innerWidth;
  result.buttons = byId('times').children.length;
  result.rows = byId('others').rows.length;
  result.events = [...byId('events').children].map(button => button.textContent);
  document.body.dataset.result = JSON.stringify(result);
})();
</script>
'''


class Case(case.OneFolder):
    def report(self, clip, output):
        """Stabilizes a clip and returns the report's data, the rows of its table, and its page."""
        self.run_command(clip, '-o', output, '--report', 'report')
        stem = self.path / 'report' / output.rsplit('.', 1)[0]
        with open(f'{stem}.csv', newline='', encoding='utf-8') as file:
            rows = list(csv.DictReader(file))
        return json.loads(Path(f'{stem}.json').read_text()), rows, Path(f'{stem}.html')


def two_shots(path):
    """Shaky views of two scenes with a cut between them, and a dark second that cannot be measured."""
    kinds.ffmpeg(*kinds.video(seconds=3), '-f', 'lavfi', '-i',
                 "mandelbrot=s=400x300:r=25,trim=end_frame=1,loop=60:1:0,crop=320:240:'40+8*sin(n/2)':'30+8*cos(n/3)'",
                 '-f', 'lavfi', '-i', 'color=black:s=320x240:r=25:d=1', '-filter_complex',
                 '[0]format=yuv420p,setsar=1[a];[1]trim=duration=2,format=yuv420p,setsar=1[b];'
                 '[2]format=yuv420p,setsar=1[c];[a][b][c]concat=n=3', *kinds.H264, path)


class Numbers(Case):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        two_shots(cls.path / 'clip.mp4')

    def test_they_are_those_of_the_estimate(self):
        data, rows, _ = self.report('clip.mp4', 'out.mp4')
        estimate = json.loads(self.run_command('--estimate', '--json', 'clip.mp4').stdout.splitlines()[-1])
        self.assertEqual((data['frames'], data['cuts'], data['lost']),
                         (estimate['frames'], estimate['cuts'], estimate['lost']))
        self.assertAlmostEqual(data['shake-before'], estimate['shake'], places=3)
        left = dict(zip(data['others']['crop-ratios'], data['others']['left'][data['others']['lambdas'].index(0.5)]))
        for crop in estimate['crops']:
            if crop['crop-ratio'] in left:
                self.assertAlmostEqual(left[crop['crop-ratio']], crop['left'], places=3)
        self.assertAlmostEqual(data['shake-after'], left[0.9] * data['shake-before'],
                               delta=0.0001 * data['shake-before'])
        self.assertEqual(len(rows), data['frames'])

    def test_the_table_and_the_data_agree(self):
        data, rows, _ = self.report('clip.mp4', 'out.mp4')
        for name in ('camera', 'path'):
            for place in ('x', 'y', 'turn', 'zoom'):
                self.assertEqual(len(data[name][place]), data['frames'])
                for value, row in zip(data[name][place], rows):
                    self.assertAlmostEqual(value, float(row[f'{name}_{place}']), delta=0.00056)
        events = [(event['frame'], event['kind']) for event in data['events']]
        self.assertEqual(events, [(i, row['event']) for i, row in enumerate(rows) if row['event']])
        self.assertIn((75, 'cut'), events)
        self.assertIn('lost', [kind for _, kind in events])

    def test_the_stabilized_path_is_smoother(self):
        data, _, _ = self.report('clip.mp4', 'out.mp4')
        for place in ('x', 'y'):
            def jumps(values):
                return sum(abs(values[i] - 2 * values[i - 1] + values[i - 2]) for i in range(2, 75))
            self.assertLess(jumps(data['path'][place]), 0.3 * jumps(data['camera'][place]))

    def test_each_file_of_a_batch_has_its_report(self):
        folder = self.path / 'many'
        folder.mkdir()
        for name in ('a.mp4', 'b.mp4'):
            shutil.copy(self.path / 'clip.mp4', folder / name)
        self.run_command('--batch', 'many', '--out-dir', 'done', '--report', 'reports')
        self.assertEqual(sorted(os.listdir(self.path / 'reports')),
                         [f'{name}-stabilized.{suffix}' for name in 'ab' for suffix in ('csv', 'html', 'json')])

    def test_it_is_refused_where_there_is_no_plain_output(self):
        for option in ('--estimate', '--compare=side'):
            run = self.run_command('clip.mp4', option, '--report', 'none', code=2)
            self.assertIn('--report', run.stderr)
        (self.path / 'file').write_text('')
        self.run_command('clip.mp4', '--report', 'file/below', '-o', 'x.mp4', code=4)
        self.assertFalse((self.path / 'none').exists() or (self.path / 'x.mp4').exists())


@unittest.skipUnless(CHROMIUM, 'the page is not looked at: Chromium is not installed (package chromium)')
class Page(Case):
    def browse(self, page, width, *options):
        """Opens a page in a frame of this width. Returns the errors of the console, and what Chromium prints."""
        frame = self.path / 'frame.html'
        frame.write_text(f'<body style="margin:0"><iframe src="{page.as_uri()}" id="page" '
                         f'style="border:0;width:{width}px;height:3400px"></iframe>')
        return self.chromium(frame, f'--window-size={max(width, 500)},3400', *options)

    def chromium(self, page, *options):
        run = subprocess.run(
            [CHROMIUM, '--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--no-first-run',
             '--hide-scrollbars', '--virtual-time-budget=15000', '--enable-logging=stderr',
             f'--user-data-dir={self.path / "profile"}', '--host-resolver-rules=MAP * ~NOTFOUND', *options,
             page.as_uri()], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, encoding='utf-8',
            errors='replace')
        return re.findall(r'CONSOLE.*', run.stderr), run.stdout

    def act(self, page):
        """Does in the page what a user does."""
        acted = self.path / 'acted.html'
        acted.write_text(page.read_text() + ACTIONS)
        errors, text = self.chromium(acted, '--window-size=500,3400', '--dump-dom')
        self.assertEqual(errors, [])
        result = re.search(r'data-result="([^"]*)"', text)
        self.assertTrue(result, text[-2000:])
        return json.loads(html.unescape(result[1]))

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        two_shots(cls.path / NAME)

    def test_it_opens_without_errors_at_the_width_of_a_phone_and_of_a_desktop(self):
        _, _, page = self.report(NAME, NAME[:-4] + '-out.mp4')
        keep = os.environ.get('SCREENSHOTS')
        for width in (PHONE, DESKTOP):
            picture = (Path(keep) if keep else self.path) / f'report-{width}.png'
            errors, _ = self.browse(page, width, f'--screenshot={picture}')
            self.assertEqual(errors, [])
            self.assertGreater(picture.stat().st_size, 50_000)
        self.assertFalse(re.search(r'(?:src|href)="?https?:|@import|url\(', page.read_text()))

    def test_an_error_of_a_page_would_be_seen(self):
        page = self.path / 'wrong.html'
        page.write_text('<script>absent()</script>')
        self.assertEqual(len(self.browse(page, PHONE)[0]), 1)

    def test_it_can_be_used_with_a_mouse_and_with_fingers(self):
        data, _, page = self.report(NAME, 'used.mp4')
        result = self.act(page)
        self.assertEqual((result['ready'], result['title']), ('yes', NAME + ' - l1l2stab'))
        self.assertAlmostEqual(result['whole'], data['time'][-1], delta=0.01)
        self.assertAlmostEqual(result['button'], result['whole'] / 2, delta=0.01)
        self.assertAlmostEqual(result['wheel'], result['whole'] * 0.8, delta=0.01)
        self.assertTrue(0.15 < result['drag'] / result['whole'] < 0.35, result)
        self.assertLess(result['points'], data['frames'] / 2)
        self.assertTrue(0.2 < result['pinch'] / result['whole'] < 0.5, result)
        self.assertTrue(result['changed'])
        self.assertFalse(result['overflow'])
        self.assertEqual((result['buttons'], result['rows']), (6, 1 + len(data['others']['lambdas'])))
        self.assertEqual(result['events'][0], '0:03.0 cut')
        self.assertIn('motion not measured, ', ' '.join(result['events']))

    def test_the_pictures_of_a_turned_film_are_upright(self):
        # Bright at the upper left, dark at the lower right; stored turned in four ways.
        upright = self.path / 'upright.mkv'
        kinds.ffmpeg('-f', 'lavfi', '-i', 'mandelbrot=s=320x240:r=25,trim=end_frame=1,loop=50:1:0', '-t', '1', '-vf',
                     "geq=lum='lum(X,Y)/4+90*(1-X/W)+60*(1-Y/H)':cb=128:cr=128", '-c:v', 'ffv1', upright)
        for angle, turn in ((90, 'transpose=cclock'), (180, 'hflip,vflip'), (270, 'transpose=clock')):
            stored, film = self.path / 'stored.mp4', self.path / f'turned{angle}.mp4'
            kinds.ffmpeg('-i', upright, '-vf', turn, *kinds.H264, stored)
            kinds.ffmpeg('-i', stored, '-c', 'copy', '-metadata:s:v', f'rotate={angle}', film)
            shown = subprocess.run(['ffmpeg', '-v', 'error', '-i', str(film), '-frames:v', '1', '-vf',
                                    'scale=2:2:flags=area,format=gray', '-f', 'rawvideo', '-'],
                                   stdout=subprocess.PIPE, check=True).stdout
            result = self.act(self.report(film.name, f'out{angle}.mp4')[2])
            self.assertEqual(result['pair'], [320, 240])
            for mine, ffmpegs in zip(result['quarters'], shown):
                self.assertAlmostEqual(mine, ffmpegs, delta=25)
            self.assertGreater(max(shown) - min(shown), 60)


if __name__ == '__main__':
    if 'built without Chart.js' in subprocess.run([L1L2STAB, '--report', tempfile.gettempdir(), 'x'],
                                                  stderr=subprocess.PIPE, encoding='utf-8').stderr:
        print('skipped: the command was built without Chart.js (package libjs-chart.js)')
        sys.exit(SKIP)
    unittest.main(argv=sys.argv[:1], verbosity=2)
