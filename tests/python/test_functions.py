# SPDX-License-Identifier: MIT
"""stabilize(), measure(), smooth() and pixel_matrix()."""
import conftest
import l1l2stab
import numpy as np
import pytest

WINDOW = 16


def test_the_shake_is_gone(clip):
    before = conftest.shake(list(l1l2stab.measure(clip, conftest.FPS)))
    after = conftest.shake(list(l1l2stab.measure(l1l2stab.stabilize(clip, conftest.FPS), conftest.FPS)))
    assert before > 3 and after < before / 10


@pytest.mark.parametrize('count', [0, 1, 3, 100])
def test_as_many_frames_come_out_as_go_in(count):
    frames = conftest.gray_clip(count)
    assert len(list(l1l2stab.stabilize(frames, window=WINDOW))) == count
    assert len(list(l1l2stab.measure(frames))) == count
    assert len(list(l1l2stab.smooth([np.eye(3)] * count, 320, 240))) == count


def test_frames_are_taken_one_by_one():
    taken = [0]

    def frames():
        for frame in conftest.gray_clip(60):
            taken[0] += 1
            yield frame

    stabilized = l1l2stab.stabilize(frames(), window=WINDOW)
    assert taken[0] == 0
    next(stabilized)
    assert taken[0] == WINDOW
    next(stabilized)
    assert taken[0] == WINDOW + 1
    stabilized.close()


def test_an_error_of_the_source_passes_through():
    def frames():
        yield conftest.gray_clip(1)[0]
        raise OSError('the camera is gone')

    with pytest.raises(OSError, match='the camera is gone'):
        list(l1l2stab.stabilize(frames()))


def test_another_size_starts_anew_and_no_frame_is_lost():
    large = conftest.gray_clip(20)
    small = [frame[:100, :200].copy() for frame in large]
    shapes = [frame.shape for frame in l1l2stab.stabilize(large + small + large[:3], window=WINDOW)]
    assert shapes == [(240, 320)] * 20 + [(100, 200)] * 20 + [(240, 320)] * 3
    with pytest.raises(ValueError, match='has the shape'):
        list(l1l2stab.measure(large + small))


def test_measured_motions_make_the_same_path_as_the_frames(clip):
    with l1l2stab.Stabilizer(conftest.WIDTH, conftest.HEIGHT, 'BGR', conftest.FPS, rolling_shutter='none') as s:
        for picture in clip:
            s.push(picture)
        s.finish()
        wanted = [output.info for output in s.ready(render=False)]
    motions = list(l1l2stab.measure(clip, conftest.FPS, rolling_shutter='none'))
    infos = list(l1l2stab.smooth(motions, conftest.WIDTH, conftest.HEIGHT, conftest.FPS))
    assert len(infos) == len(wanted)
    for info, want in zip(infos, wanted):
        for name in ('F', 'B', 'S', 'warp'):
            assert (getattr(info, name) == getattr(want, name)).all()
    matrices = [motion.matrix for motion in motions]
    again = l1l2stab.smooth(matrices, conftest.WIDTH, conftest.HEIGHT, conftest.FPS)
    assert all((a.B == b.B).all() for a, b in zip(again, infos))


def test_a_cut_is_kept_between_measuring_and_smoothing():
    frames = conftest.gray_clip(20, seed=1) + conftest.gray_clip(20, seed=9)
    motions = list(l1l2stab.measure(frames, conftest.FPS))
    assert [i for i, motion in enumerate(motions) if motion.path_start] == [0, 20]
    infos = list(l1l2stab.smooth(motions, conftest.WIDTH, conftest.HEIGHT, conftest.FPS, window=WINDOW))
    assert [info.index for info in infos if info.path_start] == [0, 20]


def test_pictures_rendered_by_opencv_with_pixel_matrix_are_those_of_the_library(clip):
    cv2 = pytest.importorskip('cv2', reason='OpenCV for Python is not installed')
    size = conftest.WIDTH, conftest.HEIGHT
    for mode in ('input', 'crop'):
        with l1l2stab.Stabilizer(*size, 'BGR', conftest.FPS, rolling_shutter='none', output_size=mode) as s:
            for picture in clip:
                s.push(picture)
            s.finish()
            for picture, output in zip(clip, s.ready()):
                matrix = l1l2stab.pixel_matrix(output.info.warp, size, s.output_size)
                own = cv2.warpPerspective(picture, matrix, s.output_size, flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)
                difference = np.abs(own.astype(int) - output.picture)[4:-4, 4:-4]
                # The tiles have hard edges: a shift by 0.1 pixels would change them by several levels on average.
                assert difference.mean() < 1
