# SPDX-License-Identifier: MIT
"""The programs of samples/python with real files: pytest test_samples.py -k opencv, imageio or pyav."""
import subprocess
import sys
from pathlib import Path

import conftest
import l1l2stab
import pytest

SAMPLES = Path(__file__).resolve().parents[2] / 'samples' / 'python'
FRAMES = 60


def write_clip(path):
    """A shaky video, made with the ffmpeg program."""
    frames = conftest.color_clip(FRAMES)
    try:
        subprocess.run(['ffmpeg', '-v', 'error', '-f', 'rawvideo', '-pix_fmt', 'bgr24', '-r', str(conftest.FPS), '-s',
                        f'{conftest.WIDTH}x{conftest.HEIGHT}', '-i', '-', '-c:v', 'libx264', '-qp', '10', '-pix_fmt',
                        'yuv420p', str(path)], input=b''.join(f.tobytes() for f in frames), check=True)
    except FileNotFoundError:
        pytest.skip('ffmpeg is not installed')


def read_clip(path):
    import numpy as np
    size = conftest.WIDTH, conftest.HEIGHT
    raw = subprocess.run(['ffmpeg', '-v', 'error', '-i', str(path), '-vsync', 'passthrough', '-f', 'rawvideo',
                          '-pix_fmt', 'gray', '-'], stdout=subprocess.PIPE, check=True).stdout
    return list(np.frombuffer(raw, np.uint8).reshape(-1, size[1], size[0]))


def check(program, tmp_path, module):
    pytest.importorskip(module, reason=f'the Python package {module} is not installed')
    source, target = tmp_path / 'in.mp4', tmp_path / 'out.mp4'
    write_clip(source)
    subprocess.run([sys.executable, SAMPLES / program, source, target], check=True, timeout=100)
    before, after = read_clip(source), read_clip(target)
    assert len(before) == len(after) == FRAMES
    shakes = [conftest.shake(list(l1l2stab.measure(clip, conftest.FPS))) for clip in (before, after)]
    assert shakes[0] > 3 and shakes[1] < shakes[0] / 5, shakes


def test_opencv_frames_are_stabilized(tmp_path):
    check('stabilize_opencv.py', tmp_path, 'cv2')


def four_pictures(cv2, sample, target):
    """The four pictures of frame 30 that a sample puts into one, row by row."""
    source = target.with_name('in.mp4')
    write_clip(source)
    subprocess.run([sys.executable, SAMPLES / sample, source, target, '30'], check=True, timeout=100)
    made = cv2.imread(str(target))
    assert made.shape == (2 * conftest.HEIGHT, 2 * conftest.WIDTH, 3)
    rows = [made[:conftest.HEIGHT], made[conftest.HEIGHT:]]
    return [half for row in rows for half in (row[:, :conftest.WIDTH], row[:, conftest.WIDTH:])]


def test_opencv_shows_a_whole_frame_and_who_gave_it(tmp_path):
    cv2 = pytest.importorskip('cv2', reason='the Python package cv2 is not installed')
    who = four_pictures(cv2, 'full_frame_opencv.py', tmp_path / 'out.png')[3].astype(int)
    assert (abs(who[..., 0] - who[..., 2]) > 20).any(), 'no neighbor gave anything'


def zoom(cv2, first, second):
    """How much larger the second picture shows what the first has: by ORB points and RANSAC."""
    orb = cv2.ORB_create(1000)
    (points, words), (others, other_words) = (orb.detectAndCompute(picture, None) for picture in (first, second))
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(words, other_words)
    here, there = (cv2.KeyPoint_convert(p, [getattr(m, name) for m in matches])
                   for p, name in ((points, 'queryIdx'), (others, 'trainIdx')))
    matrix, _ = cv2.estimateAffinePartial2D(here, there)
    return (matrix[0, 0] ** 2 + matrix[1, 0] ** 2) ** 0.5


def test_opencv_shows_a_frame_at_three_crop_ratios(tmp_path):
    cv2 = pytest.importorskip('cv2', reason='the Python package cv2 is not installed')
    filmed, *stabilized = four_pictures(cv2, 'crop_ratios_opencv.py', tmp_path / 'out.jpg')
    for picture, ratio in zip(stabilized, (0.95, 0.9, 0.8)):
        assert zoom(cv2, filmed, picture) == pytest.approx(1 / ratio, rel=0.02)


def test_imageio_frames_are_stabilized(tmp_path):
    imageio = pytest.importorskip('imageio', reason='the Python package imageio is not installed')
    if hasattr(imageio, 'v2'):  # older ones need no other package
        pytest.importorskip('imageio_ffmpeg', reason='the Python package imageio-ffmpeg is not installed')
    check('stabilize_imageio.py', tmp_path, 'imageio')


def test_pyav_frames_are_stabilized(tmp_path):
    check('stabilize_pyav.py', tmp_path, 'av')


def test_a_pyav_video_keeps_its_frame_times(tmp_path):
    av = pytest.importorskip('av', reason='the Python package av is not installed')
    source, variable, target = tmp_path / 'in.mp4', tmp_path / 'variable.mp4', tmp_path / 'out.mp4'
    write_clip(source)
    subprocess.run(['ffmpeg', '-v', 'error', '-i', source, '-vf', "select='not(eq(mod(n\\,7)\\,3))'", '-vsync',
                    'passthrough', variable], check=True)
    subprocess.run([sys.executable, SAMPLES / 'stabilize_pyav.py', variable, target], check=True, timeout=100)

    def times(path):
        with av.open(str(path)) as container:
            return [round(float(frame.time), 3) for frame in container.decode(video=0)]

    assert times(target) == times(variable) and len(set(times(target))) > 40


@pytest.mark.parametrize('program', ['stabilize_opencv.py', 'stabilize_imageio.py', 'stabilize_pyav.py'])
def test_without_arguments_a_program_says_how_it_is_used(program):
    module = {'opencv': 'cv2', 'imageio': 'imageio', 'pyav': 'av'}[program[10:-3]]
    pytest.importorskip(module, reason=f'the Python package {module} is not installed')
    run = subprocess.run([sys.executable, SAMPLES / program], stderr=subprocess.PIPE, text=True, check=False)
    assert run.returncode == 1 and run.stderr.startswith('usage: ' + program)
