# SPDX-License-Identifier: MIT
"""Pictures as arrays: formats, planes, memory that is shared and kept alive."""
import gc
import os
import re
import subprocess
import weakref
from pathlib import Path

import conftest
import l1l2stab
import numpy as np
import pytest
from l1l2stab import _pictures

TOP = Path(__file__).resolve().parents[2]
WINDOW = 8


def pictures(format, count, width=64, height=48, packed=True):
    """Random pictures of a format."""
    dice = np.random.default_rng(5)
    shape = _pictures.Shape(_pictures.LAYOUTS[format], width, height, packed)
    made = []
    for _ in range(count):
        picture = _pictures.empty(shape)
        for plane in [picture] if packed else picture:
            plane[...] = dice.integers(0, 1 << 8 * plane.itemsize, plane.shape)
        made.append(picture)
    return made


def bypassed(format, given, width=64, height=48, **settings):
    """What comes out if nothing is stabilized: the pictures themselves, to the bit."""
    with l1l2stab.Stabilizer(width, height, format, window=WINDOW, **settings) as stabilizer:
        stabilizer.bypass = True
        made = []
        for picture in given:
            stabilizer.push(picture)
            made += [output.picture for output in stabilizer.ready()]
        stabilizer.finish()
        return made + [output.picture for output in stabilizer.ready()]


def test_every_format_of_the_header_is_there():
    header = (TOP / 'lib/include/l1l2stab/l1l2stab.h').read_text(encoding='utf-8')
    names = set(re.findall(r'L1L2STAB_FORMAT_(\w+) = ', header)) - {'UNKNOWN'}
    assert set(l1l2stab.FORMATS) == names


@pytest.mark.parametrize('packed', [True, False])
@pytest.mark.parametrize('format', l1l2stab.FORMATS)
def test_a_bypassed_picture_comes_out_as_it_went_in(format, packed):
    planes = len(_pictures.LAYOUTS[format].planes)
    if planes == 1 and not packed:
        pytest.skip('has one plane')
    given = pictures(format, 10, packed=packed)
    if re.match('P01[02]', format):  # unused bits are zero
        unused = 16 - int(format[2:4])
        for picture in given:
            for plane in [picture] if packed else picture:
                plane &= 0xffff << unused & 0xffff
    elif match := re.search('_1([02])LE', format):
        for picture in given:
            for plane in [picture] if packed else picture:
                plane &= (1 << 10 + int(match[1])) - 1
    made = bypassed(format, given)
    assert len(made) == len(given)
    for before, after in zip(given, made):
        assert isinstance(after, np.ndarray) == packed
        for a, b in zip([before] if packed else before, [after] if packed else after):
            assert a.dtype == b.dtype and a.shape == b.shape and (a == b).all()


@pytest.mark.parametrize('format', ['I420', 'NV12', 'Y42B', 'BGR', 'GRAY16_LE'])
def test_odd_sizes_come_out_as_they_went_in(format):
    given = pictures(format, 6, 63, 47, packed=format not in ('I420', 'NV12', 'Y42B'))
    made = bypassed(format, given, 63, 47)
    for before, after in zip(given, made):
        for a, b in zip(before, after):
            assert (a == b).all()


def test_planes_and_one_array_give_the_same_frames_as_the_c_program():
    program = os.environ.get('STABILIZE_RAW')
    if not program:
        pytest.skip('the program stabilize-raw was not built')
    luma = conftest.gray_clip(30)
    half = conftest.HEIGHT // 2, conftest.WIDTH // 2
    tuples = [(y, y[::2, ::2].copy(), np.full(half, 90, np.uint8)) for y in luma]
    arrays = [np.concatenate([plane.reshape(-1) for plane in planes]).reshape(-1, conftest.WIDTH) for planes in tuples]
    raw = subprocess.run([program, str(conftest.WIDTH), str(conftest.HEIGHT), str(conftest.FPS)],
                         input=b''.join(a.tobytes() for a in arrays), stdout=subprocess.PIPE, check=True).stdout
    from_arrays = b''.join(a.tobytes() for a in l1l2stab.stabilize(arrays, conftest.FPS, format='I420'))
    from_tuples = b''.join(p.tobytes() for planes in l1l2stab.stabilize(tuples, conftest.FPS) for p in planes)
    assert from_arrays == raw
    assert from_tuples == raw
    assert raw != b''.join(a.tobytes() for a in arrays)


def test_frames_are_pushed_without_a_copy_and_kept_until_they_are_pulled():
    class Picture(np.ndarray):  # arrays have no weak references, their subclasses do
        pass

    stabilizer = l1l2stab.Stabilizer(64, 48, 'BGR', window=WINDOW)
    stabilizer.bypass = True
    alive = []
    for i in range(WINDOW):
        picture = np.full((48, 64, 3), i, np.uint8).view(Picture)
        alive.append(weakref.ref(picture))
        stabilizer.push(picture)
        picture[:] = 100 + i  # allowed here only to show that it is the same memory
        del picture
    gc.collect()
    assert all(reference() is not None for reference in alive)
    output = stabilizer.pull()
    assert (output.picture == 100).all()
    assert alive[0]() is None and alive[1]() is not None
    stabilizer.reset()
    assert all(reference() is None for reference in alive)


@pytest.mark.parametrize('end', ['close', 'collect', 'with'])
def test_held_frames_are_let_go_when_the_stabilizer_ends(end):
    class Picture(np.ndarray):
        pass

    picture = np.zeros((48, 64, 3), np.uint8).view(Picture)
    alive = weakref.ref(picture)
    stabilizer = l1l2stab.Stabilizer(64, 48, 'BGR')
    stabilizer.push(picture)
    del picture
    if end == 'close':
        stabilizer.close()
    elif end == 'with':
        with stabilizer:
            pass
    else:
        del stabilizer
        gc.collect()
    assert alive() is None


def test_views_with_dense_rows_are_shared_and_others_copied():
    whole = np.zeros((100, 200, 3), np.uint8)
    shape = _pictures.Shape(_pictures.LAYOUTS['BGR'], 64, 48)
    for view in (whole[10:58, 20:84], whole[58:10:-1, 20:84], whole[:96:2, 20:84]):
        plane, = _pictures.planes_of(shape, view)
        assert plane is view
    for view in (whole[10:58, 84:20:-1], whole[10:58, 20:84, ::-1], whole[10:58, :128:2]):
        plane, = _pictures.planes_of(shape, view)
        assert not np.shares_memory(plane, whole) and (plane == view).all()


def test_read_only_frames_can_be_pushed():
    data = bytes(64 * 48 * 3)
    given = [np.frombuffer(data, np.uint8).reshape(48, 64, 3)] * 4
    assert len(list(l1l2stab.stabilize(given, window=4))) == 4


def test_each_frame_comes_out_in_an_array_of_its_own(clip):
    made = list(l1l2stab.stabilize(clip, window=WINDOW))
    addresses = {_pictures.address_of(picture) for picture in made}
    assert len(addresses) == len(clip)


def test_given_arrays_are_rendered_into(clip):
    out = np.zeros((conftest.HEIGHT, conftest.WIDTH, 3), np.uint8)
    wanted = list(l1l2stab.stabilize(clip, window=WINDOW))
    count = 0
    for picture, want in zip(l1l2stab.stabilize(clip, window=WINDOW, out=out), wanted):
        assert picture is out and (picture == want).all()
        count += 1
    assert count == len(clip)


def test_a_picture_is_rendered_into_a_part_of_another(clip):
    canvas = np.zeros((conftest.HEIGHT, 2 * conftest.WIDTH, 3), np.uint8)
    wanted = next(l1l2stab.stabilize(clip, window=WINDOW))
    next(l1l2stab.stabilize(clip, window=WINDOW, out=canvas[:, conftest.WIDTH:]))
    assert (canvas[:, conftest.WIDTH:] == wanted).all()
    assert not canvas[:, :conftest.WIDTH].any()


@pytest.mark.parametrize('out, text', [
    (np.zeros((240, 320), np.uint8), 'has the shape'),
    (np.zeros((240, 320, 3), np.float32), 'uint8, not float32'),
    (np.zeros((240, 320, 3), np.uint8)[:, :, ::-1], 'side by side'),
    (np.frombuffer(bytes(240 * 320 * 3), np.uint8).reshape(240, 320, 3), 'read-only'),
])
def test_arrays_that_cannot_be_rendered_into_are_refused(clip, out, text):
    with pytest.raises((TypeError, ValueError), match=text):
        list(l1l2stab.stabilize(clip, window=WINDOW, out=out))


def test_the_output_has_the_size_of_the_crop_window(clip):
    made = next(l1l2stab.stabilize(clip, window=WINDOW, output_size='crop', crop_ratio=0.8))
    assert made.shape == (192, 256, 3)


@pytest.mark.parametrize('array, format', [
    (np.zeros((48, 64), np.uint8), 'GRAY8'),
    (np.zeros((48, 64, 3), np.uint8), 'BGR'),
    (np.zeros((48, 64, 4), np.uint8), 'BGRA'),
    (np.zeros((48, 64), np.uint16), 'GRAY16_LE'),
    (np.zeros((48, 64, 4), np.uint16), 'BGRA64_LE'),
    (tuple(np.zeros(s, np.uint8) for s in [(47, 63), (24, 32), (24, 32)]), 'I420'),
    (tuple(np.zeros(s, np.uint8) for s in [(48, 64), (48, 32), (48, 32)]), 'Y42B'),
    (tuple(np.zeros(s, np.uint8) for s in [(48, 64), (48, 64), (48, 64)]), 'Y444'),
    (tuple(np.zeros(s, np.uint8) for s in [(48, 64), (24, 32, 2)]), 'NV12'),
])
def test_the_format_follows_from_the_shape(array, format):
    assert _pictures.shape_of(array).layout.format == format


@pytest.mark.parametrize('frame, format, error, text', [
    (np.zeros((48, 64, 3)), None, ValueError, 'no format has float64'),
    (np.zeros((48, 64, 3), np.uint16), None, ValueError, 'no format has uint16'),
    (np.zeros((48, 64, 3)), 'BGR', TypeError, 'uint8, not float64'),
    (np.zeros(64, np.uint8), None, ValueError, 'is no picture'),
    (b'bytes', None, TypeError, 'not bytes'),
    (np.zeros((48, 64, 3), np.uint8), 'BRG', ValueError, "there is no format 'BRG'"),
    (np.zeros((49, 64), np.uint8), 'I420', ValueError, 'is no I420 picture'),
    (np.zeros((48, 63, 2), np.uint8), 'YUY2', ValueError, 'even width'),
    ((np.zeros((48, 64), np.uint8),) * 2, None, ValueError, 'name it'),
])
def test_frames_that_are_no_pictures_are_refused(frame, format, error, text):
    with pytest.raises(error, match=text):
        list(l1l2stab.stabilize([frame], format=format))
