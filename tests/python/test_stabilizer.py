# SPDX-License-Identifier: MIT
"""The class Stabilizer: the loop, live settings, what it reports, errors, threads and memory."""
import gc
import logging
import os
import sys
import threading
import time
import warnings
from fractions import Fraction

import conftest
import l1l2stab
import numpy as np
import pytest

WINDOW = 16


@pytest.fixture
def stabilizer():
    with l1l2stab.Stabilizer(conftest.WIDTH, conftest.HEIGHT, 'BGR', conftest.FPS, window=WINDOW) as made:
        yield made


def run(stabilizer, clip):
    """All outputs."""
    made = []
    for picture in clip:
        stabilizer.push(picture)
        made += stabilizer.ready()
    stabilizer.finish()
    return made + list(stabilizer.ready())


def test_one_frame_in_gives_one_frame_out_in_order(stabilizer, clip):
    for i, picture in enumerate(clip[:WINDOW]):
        assert stabilizer.pull() is None
        stabilizer.push(picture, tag=i, pts=i * 1000)
    assert stabilizer.held == WINDOW == stabilizer.delay
    first = stabilizer.pull()
    assert (first.tag, first.pts, first.info.index) == (0, 0, 0)
    assert stabilizer.pull() is None
    stabilizer.finish()
    rest = list(stabilizer.ready())
    assert [output.tag for output in rest] == list(range(1, WINDOW))
    assert [output.pts for output in rest] == [i * 1000 for i in range(1, WINDOW)]
    assert stabilizer.held == 0 and stabilizer.pull() is None


def test_a_frame_without_time_and_tag_has_none(stabilizer, clip):
    output = run(stabilizer, clip)[0]
    assert output.pts is None and output.tag is None


def test_a_filled_border_tells_who_gave_it(clip):
    with l1l2stab.Stabilizer(conftest.WIDTH, conftest.HEIGHT, 'BGR', conftest.FPS, window=WINDOW, border='fill',
                             fill_frames=8, crop_ratio=0.8) as stabilizer:
        with pytest.raises(l1l2stab.Error):
            stabilizer.border_map()
        filled = 0
        for picture in clip:
            stabilizer.push(picture)
            for output in stabilizer.ready():
                made = stabilizer.border_map()
                assert made.shape == output.picture.shape[:2]
                neighbors = np.count_nonzero((made != 0) & (made != 255))
                assert output.info.filled == pytest.approx(neighbors / made.size)
                assert output.info.extended == pytest.approx(np.count_nonzero(made == 255) / made.size)
                assert np.all((made == 0) | (made == 255) | (abs(made.astype(int) - 128) <= 8))
                filled += neighbors
        assert filled > 0


def test_reset_starts_anew_with_the_same_result(stabilizer, clip):
    first = run(stabilizer, clip)
    stabilizer.reset()
    second = run(stabilizer, clip)
    assert all((a.picture == b.picture).all() for a, b in zip(first, second))
    assert [output.info.index for output in second] == list(range(len(clip)))


def test_the_info_says_how_the_camera_moved(stabilizer, clip):
    infos = [output.info for output in run(stabilizer, clip)]
    camera = conftest.positions(len(clip))
    for t in range(1, len(clip)):
        moved = camera[t] - camera[t - 1]  # a point of frame t is so much farther right and down in frame t - 1
        assert np.abs(infos[t].F[:2, 2] - moved).max() < 0.1
        assert infos[t].source in ('translation', 'similarity', 'affine')
        assert infos[t].inliers > 20 and infos[t].quality > 0.5
    first, second = infos[:2]
    assert first.path_start and first.source == 'none' and (first.F == np.eye(3)).all()
    assert not second.path_start and second.path_index == 1
    assert np.allclose(second.P, second.C @ second.B, atol=1e-6)
    assert set(first.stage_ns) == {'scale', 'track', 'fit', 'solve', 'warp'} and first.stage_ns['warp'] > 0
    assert first.lambda_ == 0.5 and first.crop_ratio == 0.9 and first.solver in ('predictor', 'checked', 'osqp')


def test_settings_change_meanwhile(stabilizer, clip):
    stabilizer.push(clip[0])
    stabilizer.lambda_, stabilizer.crop_ratio = 2, 0.8
    assert (stabilizer.lambda_, stabilizer.crop_ratio) == (2, 0.8)
    infos = [output.info for output in run(stabilizer, clip[1:])]
    assert [info.lambda_ for info in infos[:2]] == [0.5, 2]
    assert infos[0].crop_ratio == 0.9 and infos[-1].crop_ratio == pytest.approx(0.8)
    stabilizer.reset()
    stabilizer.bypass = True
    outputs = run(stabilizer, clip)
    assert stabilizer.bypass and outputs[-1].info.bypass == 1
    assert (outputs[-1].picture == clip[-1]).all()


def test_hurried_frames_come_early(stabilizer, clip):
    for picture in clip[:5]:
        stabilizer.push(picture)
    stabilizer.hurry(2)
    outputs = list(stabilizer.ready())
    assert len(outputs) == 2 and all(output.info.early for output in outputs)


def test_a_discontinuity_starts_a_path(stabilizer, clip):
    for i, picture in enumerate(clip):
        stabilizer.push(picture, discontinuity=i == 5)
        list(stabilizer.ready(render=False)) if i < 5 else None
        if i == 10:
            break
    stabilizer.finish()
    starts = [output.info.path_start for output in stabilizer.ready(render=False)]
    assert starts == [i == 5 or i == 0 for i in range(11)]


def test_a_region_and_a_mask_choose_what_is_measured(clip):
    still = clip[0]
    half = [np.concatenate([frame[:, :160], still[:, 160:]], axis=1) for frame in clip]  # the right half never moves
    mask = np.zeros((24, 32), bool)
    mask[:, 17:] = True
    for settings in ({'region': (0.55, 0, 0.45, 1)}, {'mask': mask}):
        motions = list(l1l2stab.measure(half, conftest.FPS, **settings))
        assert conftest.shake(motions) < 0.1
    assert conftest.shake(list(l1l2stab.measure(half, conftest.FPS, region=(0, 0, 0.45, 1)))) > 1


def test_sizes_and_settings_can_be_read():
    with l1l2stab.Stabilizer(320, 240, 'rgb', Fraction(30000, 1001), output_size='crop', crop_ratio=0.8, threads=2
                             ) as stabilizer:
        assert (stabilizer.width, stabilizer.height, stabilizer.format) == (320, 240, 'RGB')
        assert stabilizer.output_size == (256, 192) and stabilizer.threads == 2 and stabilizer.delay == 150
        assert repr(stabilizer) == '<Stabilizer 320x240 RGB, 0 frames held>'
    assert 'closed' in repr(stabilizer)


# ---- errors ----

def test_an_error_carries_the_log_line():
    with pytest.raises(l1l2stab.ArgumentError, match=r'^window is 2: choose a value from 4 to 900$') as caught:
        l1l2stab.Stabilizer(320, 240, window=2)
    assert caught.value.result == -1 and caught.value.log == str(caught.value)
    assert isinstance(caught.value, ValueError) and isinstance(caught.value, l1l2stab.Error)


def test_errors_come_when_stabilize_is_called_and_not_at_the_first_frame():
    with pytest.raises(l1l2stab.ArgumentError, match='lambda is -1'):
        l1l2stab.stabilize([], lambda_=-1)
    with pytest.raises(TypeError, match="there is no setting 'lamda': the settings are lambda_, crop_ratio"):
        l1l2stab.measure([], lamda=1)
    with pytest.raises(ValueError, match="join is 'x': choose one of 'continuous', 'blend'"):
        l1l2stab.smooth([], 320, 240, join='x')
    with pytest.raises(ValueError, match='weights has 2 numbers: give 3'):
        l1l2stab.stabilize([], weights=(1, 2))
    with pytest.raises(ValueError, match='mask is an array of float64'):
        l1l2stab.stabilize([], mask=np.zeros((4, 4)))


def test_calls_out_of_order_are_errors(stabilizer, clip):
    stabilizer.finish()
    with pytest.raises(l1l2stab.StateError, match='reset'):
        stabilizer.push(clip[0])
    stabilizer.reset()
    for picture in clip[:WINDOW]:
        stabilizer.push(picture)
    with pytest.raises(l1l2stab.StateError, match='16 frames are held.*pull first'):
        stabilizer.push(clip[WINDOW])
    assert stabilizer.held == WINDOW and stabilizer.pull() is not None
    stabilizer.close()
    stabilizer.close()
    for call in (stabilizer.pull, stabilizer.finish, stabilizer.reset, lambda: stabilizer.push(clip[0])):
        with pytest.raises(l1l2stab.StateError, match='closed'):
            call()


def test_after_an_error_the_stream_goes_on(stabilizer, clip):
    for i, picture in enumerate(clip):
        with pytest.raises(ValueError, match=r'has the shape \(240, 320, 3\), not \(10, 10, 3\)'):
            stabilizer.push(np.zeros((10, 10, 3), np.uint8))
        with pytest.raises(l1l2stab.ArgumentError, match='motion'):
            stabilizer.push(None, motion=np.diag([5.0, 5, 1]))
        with pytest.raises(l1l2stab.ArgumentError, match='lambda is -1'):
            stabilizer.lambda_ = -1
        stabilizer.push(picture)
        if stabilizer.held == WINDOW:
            assert stabilizer.pull().info.index == i - WINDOW + 1
    assert stabilizer.lambda_ == 0.5 and stabilizer.take_error() is None


def test_log_lines_go_to_the_logging_of_python(caplog):
    cut = conftest.gray_clip(4, seed=1) + conftest.gray_clip(4, seed=9)
    with caplog.at_level(logging.DEBUG, logger='l1l2stab'):
        list(l1l2stab.stabilize(cut, window=4))
    assert [(record.name, record.levelno) for record in caplog.records] == [('l1l2stab', logging.DEBUG)]
    assert caplog.records[0].message.startswith('motion: ')
    caplog.clear()
    list(l1l2stab.stabilize(cut, window=4))
    assert not caplog.records


def test_an_array_that_is_pushed_while_it_is_held_makes_one_warning(stabilizer, clip):
    with pytest.warns(RuntimeWarning, match='push copies') as caught:
        for _ in range(4):
            stabilizer.push(clip[0])
    assert len(caught) == 1 and caught[0].filename == __file__
    with pytest.warns(RuntimeWarning, match='push copies') as caught:
        list(l1l2stab.stabilize([clip[0]] * 3))
    assert len(caught) == 1 and caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter('error')
        clip[1].flags.writeable = False
        for _ in range(4):
            stabilizer.push(clip[1])


# ---- threads and memory ----

def test_other_threads_run_while_the_library_works(clip):
    interval = sys.getswitchinterval()
    ticks, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            ticks[0] += 1
            time.sleep(0)  # lets others run

    thread = threading.Thread(target=count)
    sys.setswitchinterval(1000)  # a thread runs until it lets others run
    try:
        with l1l2stab.Stabilizer(conftest.WIDTH, conftest.HEIGHT, 'BGR', window=30, threads=1) as stabilizer:
            thread.start()
            counts = []
            for picture in clip[:30]:
                before = ticks[0]
                stabilizer.push(picture)
                counts.append(ticks[0] - before)
    finally:
        stop.set()
        sys.setswitchinterval(interval)
        thread.join()
    assert sum(count > 0 for count in counts) > 10


def test_calls_from_several_threads_wait_for_each_other():
    frames = conftest.gray_clip(8)
    stabilizer = l1l2stab.Stabilizer(conftest.WIDTH, conftest.HEIGHT, 'GRAY8', window=4)
    pushed, pulled, lock = [0], [0], threading.Lock()

    def work():
        for i in range(60):
            try:
                stabilizer.push(frames[i % 8].copy())
                with lock:
                    pushed[0] += 1
            except l1l2stab.StateError:  # full
                pass
            if stabilizer.pull() is not None:
                with lock:
                    pulled[0] += 1

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    stabilizer.finish()
    assert pulled[0] + len(list(stabilizer.ready())) == pushed[0] > 60


def test_two_instances_in_two_threads_give_the_same_frames(clip):
    wanted = list(l1l2stab.stabilize(clip, window=WINDOW))
    results = [None, None]

    def work(i):
        results[i] = list(l1l2stab.stabilize(clip, window=WINDOW, threads=1 + i))

    threads = [threading.Thread(target=work, args=(i,)) for i in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for result in results:
        assert all((a == b).all() for a, b in zip(result, wanted))


def resident_kb():
    with open('/proc/self/statm', encoding='ascii') as statm:
        return int(statm.read().split()[1]) * os.sysconf('SC_PAGE_SIZE') // 1024


def test_memory_is_flat_over_5000_frames():
    whole = conftest.scene()
    dice = np.random.default_rng(7)

    def frames(count):
        for x, y in dice.integers(0, 9, (count, 2)):
            yield np.repeat(whole[y:y + 48, x:x + 64, None], 3, axis=2)

    frame_kb = 48 * 64 * 3 / 1024
    at = {}
    for i, _ in enumerate(l1l2stab.stabilize(frames(5000), conftest.FPS, window=30)):
        if i in (1000, 4900):
            gc.collect()
            at[i] = resident_kb()
    # 3,900 frames of 9 KB would be 35 MB, and one matrix a frame 1 MB.
    assert at[4900] - at[1000] < 60 * frame_kb, at


def test_instances_leave_no_memory_behind():
    clip = conftest.gray_clip(5)

    def use():
        stabilizer = l1l2stab.Stabilizer(conftest.WIDTH, conftest.HEIGHT, 'GRAY8', window=4, threads=2)
        for picture in clip:
            stabilizer.push(picture)
            stabilizer.pull()

    for _ in range(20):
        use()
    before = resident_kb()
    for _ in range(100):
        use()
    gc.collect()
    assert resident_kb() - before < 4000  # kB; 100 instances take 40 KB each at the very least
