#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Compares the element with vid.stab (two passes) and deshake on real clips: the picture shown, the shake that remains,
the likeness of neighboring frames, and the time. Prints Markdown tables; docs/comparison.md has them.

usage: compare_quality.py BUILD_DIR CLIP... [--methods NAME,...] [--rounds N] [--frames N]
       [--jobs N] [--keep FOLDER]

Motion is measured by OpenCV's alignment of whole pictures, findTransformECC(), so that no program is judged by its own
tracker. Lengths are in pixels of a picture scaled to a width of 640.

  shown   part of each side of the filmed frame that the result shows: the median of sqrt(det A) over every eighth
          frame, where A maps the result to the frame as filmed (ORB points, affine, RANSAC)
  jitter  root mean square of the second difference of the path of the frame's corners, times "shown". Without that
          factor, a result that shows less would look shakier for its zoom alone
  high    the same of the part that is faster than a tenth of the frame rate, 3 Hz at 30 frames/s: what looks nervous
  PSNR    mean over neighboring frames, dB. All results of a clip are cut to the same part of the filmed frame, scaled
          to 320 px and blurred, so that neither zoom nor a soft warp gains or loses
  time    wall time of decoding, stabilizing and writing raw frames, ms per frame, the median of N runs; vid.stab's two
          passes together

Needs ffmpeg with vid.stab (Debian's has it), gst-launch-1.0, and python3-opencv.
"""
import argparse
import concurrent.futures
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import cv2
import numpy as np

WIDTH = 640            # px: lengths refer to a picture of this width
SMALL = 320            # px: the width at which pictures are aligned and compared
ALIGN_BLUR = 1.2       # px: makes the alignment converge from farther away
PSNR_BLUR = 0.75       # px at SMALL: about what a bilinear warp loses
GOOD = 0.98            # correlation at which no other start is tried
MOST_DIFFERENCE = 20   # gray levels
FAST = 0.1             # of the frame rate
ECC_END = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 10, 1e-6)
GEOMETRY_STEP = 8      # frames
POINTS = 500           # of ORB, in a picture
SKIP = 77

FFMPEG = ('ffmpeg', '-v', 'error', '-nostdin', '-y', '-i')
RAW = ('-an', '-fps_mode', 'passthrough', '-pix_fmt', 'yuv420p', '-f', 'rawvideo')
PADDED = 4             # bytes: GStreamer's rows are a multiple of it, FFmpeg's are not padded


def filmed(_settings, clip, output):
    yield [*FFMPEG, clip, *RAW, output]


def vidstab(settings, clip, output):
    motion = f'{output}.trf'
    yield [*FFMPEG, clip, '-vf', f'vidstabdetect=result={motion}', '-an', '-f', 'null', '-']
    yield [*FFMPEG, clip, '-vf', ':'.join([f'vidstabtransform=input={motion}', *settings]), *RAW, output]


def deshake(settings, clip, output):
    yield [*FFMPEG, clip, '-vf', ':'.join(['deshake', *settings]).replace(':', '=', 1), *RAW, output]


def l1l2stab(settings, clip, output):
    yield ['gst-launch-1.0', '-q', 'filesrc', f'location={clip}', '!', 'decodebin', '!', 'l1l2stab', *settings, '!',
           'video/x-raw,format=I420', '!', 'filesink', f'location={output}']


PROGRAMS = {'filmed': filmed, 'vid.stab': vidstab, 'deshake': deshake, 'l1l2stab': l1l2stab}
METHODS = ('vid.stab smoothing=30', 'deshake', 'l1l2stab')


def run(method, clip, output):
    """Runs a method's commands, and returns their wall time in seconds."""
    name, *settings = method.split()
    started = time.monotonic()
    for command in PROGRAMS[name](settings, str(clip), str(output)):
        subprocess.run(command, check=True, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    return time.monotonic() - started


def luma_of(path, size):
    """The brightness of all frames of a file of raw 4:2:0 frames, as an array that maps the file."""
    width, height = size
    align = PADDED if path.name.endswith('.gst') else 1
    row, chroma_row = (-(-length // align) * align for length in (width, (width + 1) // 2))
    frames = np.memmap(path, np.uint8, 'r').reshape(-1, row * height + 2 * chroma_row * ((height + 1) // 2))
    return frames[:, :row * height].reshape(-1, height, row)[:, :, :width]


def frames_of(path, size, most):
    """The first frames, at the common width."""
    return [scaled(np.ascontiguousarray(frame), WIDTH) for frame in luma_of(path, size)[:most]]


def size_of(clip):
    video = cv2.VideoCapture(str(clip))
    return int(video.get(cv2.CAP_PROP_FRAME_WIDTH)), int(video.get(cv2.CAP_PROP_FRAME_HEIGHT))


def scaled(picture, width):
    height = round(picture.shape[0] * width / picture.shape[1])
    smaller = width < picture.shape[1]
    return cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA if smaller else cv2.INTER_LINEAR)


def points_of(picture):
    return cv2.ORB_create(POINTS).detectAndCompute(picture, None)


def matched(first, second, estimate):
    """The map from the ORB points of one picture to those of another by RANSAC, or None."""
    (points, words), (others, other_words) = first, second
    if words is None or other_words is None:
        return None
    matches = cv2.BFMatcher(cv2.NORM_HAMMING, crossCheck=True).match(words, other_words)
    if len(matches) < 20:
        return None
    here = np.float32([points[match.queryIdx].pt for match in matches])
    there = np.float32([others[match.trainIdx].pt for match in matches])
    matrix, inliers = estimate(here, there, method=cv2.RANSAC, ransacReprojThreshold=2)
    return matrix if matrix is not None and inliers.sum() >= 20 else None


def shifted(first, second):
    """The shift between two pictures, by the phases of their spectra."""
    window = cv2.createHanningWindow(first.shape[::-1], cv2.CV_32F)
    (x, y), _ = cv2.phaseCorrelate(first.copy(), second.copy(), window)  # which writes into its pictures
    return np.array([[1, 0, x], [0, 1, y]])


def starts_of(first, second, points, last):
    """Where the alignment can start from, the most likely first."""
    by_points = matched(*points, cv2.estimateAffinePartial2D)
    if by_points is not None:
        yield by_points
    yield last
    yield shifted(first, second)
    yield np.eye(2, 3)


def similarity(matrix, center):
    """The nearest map that only moves, turns and scales, and moves the center as the affine map does."""
    a, b = (matrix[0, 0] + matrix[1, 1]) / 2, (matrix[1, 0] - matrix[0, 1]) / 2
    turn = np.array([[a, -b], [b, a]])
    return np.column_stack([turn, matrix[:, :2] @ center + matrix[:, 2] - turn @ center])


def difference(first, second, matrix):
    """The mean difference after the alignment. What moves by itself counts no more than MOST_DIFFERENCE."""
    flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
    moved = cv2.warpAffine(second, matrix, first.shape[::-1], flags=flags, borderValue=-1e9)
    inside = moved >= 0
    differences = np.minimum(np.abs(first - moved)[inside], MOST_DIFFERENCE)
    return differences.mean() if inside.mean() > 0.3 else np.inf


def aligned(first, second, starts):
    """The similarity between two pictures by findTransformECC(): from the first start that leads to a good correlation,
    or else of all results the one with the least difference."""
    center = np.array(first.shape[::-1]) / 2
    best, matrix = np.inf, np.eye(2, 3)
    for start in starts:
        try:
            correlation, found = cv2.findTransformECC(first, second, start.astype(np.float32), cv2.MOTION_AFFINE,
                                                      ECC_END, None, 1)
        except cv2.error:  # it did not converge
            continue
        found = similarity(found, center)
        if correlation > GOOD:
            return found
        if (left := difference(first, second, found)) < best:
            best, matrix = left, found
    return matrix


def motions_of(frames):
    """The motion between neighboring frames, 2x3, with the origin in the center, in px at the common width."""
    small = [scaled(frame, SMALL) for frame in frames]
    points = [points_of(picture) for picture in small]
    blurred = [cv2.GaussianBlur(picture, (0, 0), ALIGN_BLUR).astype(np.float32) for picture in small]
    center = np.array(small[0].shape[::-1]) / 2
    last = np.eye(2, 3)
    motions = []
    for i in range(1, len(small)):
        first, second = blurred[i - 1:i + 1]
        last = aligned(first, second, starts_of(first, second, points[i - 1:i + 1], last))
        shift = last[:, :2] @ center + last[:, 2] - center
        motions.append(np.column_stack([last[:, :2], shift * WIDTH / SMALL]))
    return np.array(motions)


def jitter(motions, height):
    """The root mean square of the second difference of the corners' paths: all of it, and its fast part."""
    corners = np.array([[x * WIDTH / 2, y * height / 2] for x in (-1, 1) for y in (-1, 1)])
    velocity = np.array([corners @ motion[:, :2].T + motion[:, 2] - corners for motion in motions])
    second = np.diff(velocity, axis=0).reshape(len(motions) - 1, -1)
    spectrum = np.fft.rfft(second, axis=0)
    spectrum[np.fft.rfftfreq(len(second)) < FAST] = 0
    fast = np.fft.irfft(spectrum, len(second), axis=0)
    return tuple(float(np.sqrt((values ** 2).sum(axis=1).mean() / len(corners))) for values in (second, fast))


def shown(source, result):
    """The part of each side of the source that the result shows."""
    parts = []
    for first, second in list(zip(source, result))[::GEOMETRY_STEP]:
        matrix = matched(points_of(second), points_of(first), cv2.estimateAffine2D)
        if matrix is not None:
            parts.append(np.sqrt(abs(np.linalg.det(matrix[:, :2]))))
    return float(np.median(parts)) if parts else 1.0


def psnr(frames, part):
    """The mean PSNR of neighboring frames of this central part of the frame."""
    height, width = frames[0].shape
    x, y = round(width * (1 - part) / 2), round(height * (1 - part) / 2)
    cut = [scaled(frame[y:height - y, x:width - x], SMALL) for frame in frames]
    cut = [cv2.GaussianBlur(frame, (0, 0), PSNR_BLUR).astype(np.float64) for frame in cut]
    errors = [max(((first - second) ** 2).mean(), 1e-3) for first, second in zip(cut, cut[1:])]
    return float(np.mean([10 * np.log10(255 ** 2 / error) for error in errors]))


def measured(path, source, size, most):
    """The part that is shown, and the jitter, of a result or of the source itself."""
    frames = frames_of(path, size, most)
    part = 1.0 if path == source else shown(frames_of(source, size, most), frames)
    all_of_it, fast = jitter(motions_of(frames), frames[0].shape[0])
    return {'shown': part, 'jitter': all_of_it * part, 'high': fast * part}


def measured_psnr(path, part, size, most):
    return psnr(frames_of(path, size, most), min(part, 1))


def compare(clip, methods, arguments, folder):
    """The figures of each method for one clip."""
    size, most = size_of(clip), arguments.frames
    paths = {method: folder / f'{clip.stem}-{method.replace(" ", "-")}.{"gst" if method.startswith("l1l2") else "yuv"}'
             for method in methods}
    times = {method: [] for method in methods}
    for _ in range(arguments.rounds):  # the methods take turns, so that all run under the same load
        for method in methods:
            times[method].append(run(method, clip, paths[method]))
    source, count = paths['filmed'], len(luma_of(paths['filmed'], size))
    with concurrent.futures.ProcessPoolExecutor(arguments.jobs) as pool:
        measures = [pool.submit(measured, path, source, size, most) for path in paths.values()]
        results = dict(zip(methods, [measure.result() for measure in measures]))
        least = min(result['shown'] for result in results.values())
        measures = [pool.submit(measured_psnr, path, least / results[method]['shown'], size, most)
                    for method, path in paths.items()]
        for result, measure in zip(results.values(), measures):
            result['psnr'] = measure.result()
    for method, result in results.items():
        if (frames := len(luma_of(paths[method], size))) != count:
            print(f'{clip.name}: {method} has {frames} of {count} frames', file=sys.stderr)
        result['time'] = 1000 * statistics.median(times[method]) / count
    return results


def row(cells):
    print('| ' + ' | '.join(cells) + ' |', flush=True)


def print_clip(name, results):
    for method, result in results.items():
        row([name, method, f"{100 * result['shown']:.0f} %", f"{result['jitter']:.2f}", f"{result['high']:.2f}",
             f"{result['psnr']:.1f}", f"{result['time']:.1f}"])
        name = ''


def print_summary(clips, methods):
    """The means of all clips: geometric ones of jitter and high, so that no clip dominates."""
    print()
    row(['mean of the clips', 'shown', 'jitter', 'high', 'PSNR', 'time'])
    row(['---'] * 6)
    for method in methods:
        mean = {key: np.mean([results[method][key] for results in clips.values()]) for key in
                ('shown', 'psnr', 'time')}
        for key in ('jitter', 'high'):
            mean[key] = np.exp(np.mean([np.log(results[method][key]) for results in clips.values()]))
        row([method, f"{100 * mean['shown']:.0f} %", f"{mean['jitter']:.2f}", f"{mean['high']:.2f}",
             f"{mean['psnr']:.1f}", f"{mean['time']:.1f}"])


def print_losses(clips, methods):
    """Where another program is better than the element with its default settings."""
    print()
    others = [method for method in methods if method not in ('filmed', 'l1l2stab')]
    for key, sign in (('jitter', 1), ('high', 1), ('psnr', -1), ('time', 1)):
        lost = []
        for name, results in clips.items():
            for method in others:
                theirs, own = results[method][key], results['l1l2stab'][key]
                if sign * theirs < sign * own:
                    lost.append(f'{name}: {method} {theirs:.2f}, l1l2stab {own:.2f}')
        print(f'* {key}: ' + ('; '.join(lost) or 'no other program is better on any clip'))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('build', type=Path)
    parser.add_argument('clips', nargs='+', type=Path)
    parser.add_argument('--methods', default=','.join(METHODS), help='separated by commas (default: %(default)s)')
    parser.add_argument('--rounds', type=int, default=3, help='of the time (default: %(default)s)')
    parser.add_argument('--frames', type=int, default=300, help='of a clip that are measured (default: %(default)s)')
    parser.add_argument('--jobs', type=int, default=2, help='that measure (default: %(default)s)')
    parser.add_argument('--keep', type=Path, help='the folder to leave the results in, as raw video')
    arguments = parser.parse_args()
    missing = [str(clip) for clip in arguments.clips if not clip.is_file()]
    if missing:
        print(f'skipped: no such clip: {", ".join(missing)}', file=sys.stderr)
        return SKIP
    os.environ['GST_PLUGIN_PATH'] = str(arguments.build.resolve() / 'plugin/gstreamer')
    methods = ['filmed', *arguments.methods.split(',')]
    cv2.setNumThreads(1)
    row(['clip', 'program', 'shown', 'jitter, px', 'high, px', 'PSNR, dB', 'time, ms'])
    row(['---'] * 7)
    clips = {}
    for clip in arguments.clips:
        with tempfile.TemporaryDirectory() as work:
            folder = arguments.keep or Path(work)
            folder.mkdir(exist_ok=True)
            clips[clip.stem] = compare(clip, methods, arguments, folder)
        print_clip(clip.stem, clips[clip.stem])
    print_summary(clips, methods)
    print_losses(clips, methods)
    return 0


if __name__ == '__main__':
    sys.exit(main())
