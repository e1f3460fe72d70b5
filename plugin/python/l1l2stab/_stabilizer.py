# SPDX-License-Identifier: MIT
"""The class Stabilizer: the loop of push and pull, and what it tells of each frame."""
from __future__ import annotations

import sys
import threading
import warnings
import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterator, Optional

import numpy as np

from . import _library, _pictures
from ._cffi import ffi, lib
from ._pictures import Picture
from ._settings import Settings, make_config

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self, Unpack

_MATRICES = ('F', 'B', 'S', 'C', 'P', 'warp')
_FLAGS = {name: getattr(lib, 'L1L2STAB_INFO_' + name.upper())
          for name in ('path_start', 'motion_lost', 'path_fallback', 'early', 'motion_failed', 'bridged')}
_SAME_FIELDS = ('index', 'path_index', 'crop_ratio', 'tracks', 'inliers', 'solver_iterations', 'solver_bound',
                'quality', 'bypass', 'residual', 'readout', 'filled', 'extended')
_SOURCES = {value: name for name, value in _library.constants('L1L2StabMotionSource').items()}
_SOLVERS = {value: name for name, value in _library.constants('L1L2StabSolver').items()}
_STAGES = {name: value for name, value in _library.constants('L1L2StabStage').items() if name != 'count'}
_NO_PTS = lib.L1L2STAB_NO_PTS


@dataclass(frozen=True, eq=False)
class Info:
    """What was measured in a frame, and what was done to it.

    Matrices are (3, 3) arrays of float64. They act on columns (x, y, 1) in pixels, with the origin at the frame's
    center, x to the right and y down. pixel_matrix() converts them to positions in arrays.

    index: the frame's number since the beginning or the last reset(), from 0
    path_index: the frame's number in its path, from 0. A cut starts a path
    F: motion of the camera, from this frame to the one before; the identity at a path's first frame
    B: update transform, from the crop window to this frame
    S: smooth step, the motion that is left
    C, P: the camera's path and the smoothed path C B, from the path's first frame
    warp: from a pixel of the output to a pixel of this frame: what was rendered, without the rolling-shutter correction
    lambda_: the setting that this frame was pushed with
    crop_ratio: value in effect for this frame; after a change it ramps to the new setting
    tracks: points that were tracked into this frame
    inliers: of these, points that agree with F
    source: where F came from: 'none' (a path's first frame), 'identity' or 'predicted' (nothing could be measured),
        'given', 'translation', 'similarity', 'affine' or 'alignment' (of whole pictures)
    quality: of F, [0, 1]: 0 not measured, 1 where points all over the frame agree
    bypass: of what was rendered, [0, 1]: 0 stabilized, 1 untouched
    residual: rolling-shutter correction: the longest distance by which it moved a sample, pixels
    readout: time from the first row to the last, frames, as estimated; < 0: bottom row first; 0: not known
    filled: with border='fill': the part of the picture that neighboring frames gave, [0, 1]
    extended: with 'fill' and 'extend': the part that no frame shows and that was made up, [0, 1]
    path_start: first frame of a path
    motion_lost: the motion into this frame was not measured
    path_fallback: the solver did not converge, and a feasible path was held instead
    early: hurry() decided the frame
    motion_failed: measuring met an error, see take_error()
    bridged: F was changed by aligning pictures across frames that have no tracks
    stage_ns: time spent in each stage, nanoseconds: 'scale', 'track', 'fit', 'solve', 'warp'
    solver: which solver decided: 'predictor', 'osqp', or 'checked' where both agree
    solver_iterations, solver_bound, solver_residual: of the window that this frame came from, see l1l2stab.h
    """
    index: int
    path_index: int
    F: np.ndarray
    B: np.ndarray
    S: np.ndarray
    C: np.ndarray
    P: np.ndarray
    warp: np.ndarray
    lambda_: float
    crop_ratio: float
    tracks: int
    inliers: int
    source: str
    quality: float
    bypass: float
    residual: float
    readout: float
    filled: float
    extended: float
    path_start: bool
    motion_lost: bool
    path_fallback: bool
    early: bool
    motion_failed: bool
    bridged: bool
    stage_ns: dict[str, int]
    solver: str
    solver_iterations: int
    solver_bound: float
    solver_residual: tuple[float, float]


def _info_of(c: Any) -> Info:
    """The dataclass of an L1L2StabInfo."""
    values = {name: getattr(c, name) for name in _SAME_FIELDS}
    for name in _MATRICES:
        values[name] = np.array(list(getattr(c, name))).reshape(3, 3)
    for name, bit in _FLAGS.items():
        values[name] = bool(c.flags & bit)
    return Info(lambda_=getattr(c, 'lambda'), source=_SOURCES[c.model], solver=_SOLVERS[c.solver],
                stage_ns={name: c.stage_ns[i] for name, i in _STAGES.items()},
                solver_residual=tuple(c.solver_residual), **values)


@dataclass(frozen=True, eq=False)
class Output:
    """A frame that was pulled.

    picture: the stabilized picture, in the form of the pushed one: one array, or a tuple of planes. None without render
    info: what was measured and done
    pts: the frame's time as it was pushed, nanoseconds, or None
    tag: the object that was pushed with the frame
    """
    picture: Optional[Picture]
    info: Info
    pts: Optional[int]
    tag: Any


def _callers_level() -> int:
    """The stacklevel by which a warning names the line outside this package."""
    level, frame = 1, sys._getframe(1)
    while frame.f_back and frame.f_globals.get('__package__') == __package__:
        level, frame = level + 1, frame.f_back
    return level


def _free(instance: Any, stream: _library.Stream, keep: list[Any]) -> None:
    """`keep` is what has to live as long as the instance."""
    lib.l1l2stab_free(instance)
    stream.settle()


class Stabilizer:
    """A stream of frames of one size and format.

        with l1l2stab.Stabilizer(1920, 1080, 'BGR', fps=30) as stabilizer:
            for picture in pictures:
                stabilizer.push(picture)
                for output in stabilizer.ready():
                    show(output.picture)
            stabilizer.finish()
            for output in stabilizer.ready():
                show(output.picture)

    width, height: of the frames, pixels, [16, 16384]
    format: one of FORMATS
    fps: frames a second, [0, 1000]; 0: unknown, taken as 30
    settings: see Settings

    One frame in, one frame out, in order. A frame can be pulled when `window` - 1 more have been pushed, or after
    finish(). Calls of one instance from several threads wait for each other. The GIL is released meanwhile.

    Log lines of the library go to the logger 'l1l2stab' of Python's logging, whose level is read when an instance is
    made. The line of an error is the text of the exception.
    """

    def __init__(self, width: int, height: int, format: str = 'BGR', fps: float = 0, **settings: Unpack[Settings]
                 ) -> None:
        self._shape = _pictures.Shape(_pictures.layout_named(format), width, height)
        self._stream = _library.Stream()
        config, keep = make_config(self._stream, self._shape, fps, settings)
        self._lambda: float = getattr(config, 'lambda')
        self._crop_ratio: float = config.crop_ratio
        self._bypass = False
        self._delay: int = config.window
        self._held = 0
        self._warned = False
        self._lock = threading.Lock()
        self._instance = ffi.new('L1L2Stab **')
        self._close = weakref.finalize(self, _free, self._instance, self._stream, keep)
        result = lib.l1l2stab_create(self._instance, config)
        self._stream.report(self._stream.settle(), result)

        output_size = ffi.new('int[2]')
        lib.l1l2stab_config_output_size(config, output_size, output_size + 1)
        self._output_size = (output_size[0], output_size[1])

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def __repr__(self) -> str:
        state = f'{self._held} frames held' if self._close.alive else 'closed'
        return f'<Stabilizer {self.width}x{self.height} {self.format}, {state}>'

    @property
    def width(self) -> int:
        """Of the frames that are pushed, pixels."""
        return self._shape.width

    @property
    def height(self) -> int:
        """Of the frames that are pushed, pixels."""
        return self._shape.height

    @property
    def format(self) -> str:
        """Of the frames, one of FORMATS."""
        return self._shape.layout.format

    @property
    def output_size(self) -> tuple[int, int]:
        """Width and height of the frames that are pulled, pixels."""
        return self._output_size

    @property
    def delay(self) -> int:
        """The setting `window`: frames that have to be pushed before the first can be pulled."""
        return self._delay

    @property
    def held(self) -> int:
        """Frames that have been pushed and not yet pulled."""
        return self._held

    @property
    def threads(self) -> int:
        """How many threads work on a frame, including the caller's."""
        return self._call(lib.l1l2stab_threads)

    @property
    def lambda_(self) -> float:
        """The setting for the frames that are pushed from now on, [0, 1000]."""
        return self._lambda

    @lambda_.setter
    def lambda_(self, value: float) -> None:
        self._call(lib.l1l2stab_set_lambda, value)
        self._lambda = value

    @property
    def crop_ratio(self) -> float:
        """The setting for the frames that are pushed from now on, [0.5, 0.99]. It changes by 0.005 a frame at most."""
        return self._crop_ratio

    @crop_ratio.setter
    def crop_ratio(self, value: float) -> None:
        self._call(lib.l1l2stab_set_crop_ratio, value)
        self._crop_ratio = value

    @property
    def bypass(self) -> bool:
        """True: frames that are pulled from now on are not stabilized. The picture changes over 30 frames."""
        return self._bypass

    @bypass.setter
    def bypass(self, value: bool) -> None:
        self._call(lib.l1l2stab_set_bypass, value)
        self._bypass = bool(value)

    def push(self, picture: Optional[Picture], *, pts: Optional[int] = None, tag: Any = None,
             discontinuity: bool = False, motion: Optional[ArrayLike] = None) -> None:
        """Hands over the next frame.

        picture: an array or a tuple of planes. The library reads this memory until the frame has been pulled, so it
            must not be changed before: push a copy if your reader fills the same array again. Rows whose samples do
            not lie side by side (such as a picture mirrored by picture[:, ::-1]) are copied. None: no picture, with
            `motion` only
        pts: the frame's time, nanoseconds; where frames are not evenly spaced, the path is smooth in time
        tag: any object; pull() returns it with the frame
        discontinuity: a new path starts here: no frame before belongs to the same shot
        motion: (3, 3): F of this frame, where it is known; None: it is measured
        """
        if picture is None and motion is None:
            raise TypeError('push() needs a picture, or a motion, or both')
        arrays = [] if picture is None else _pictures.planes_of(self._shape, picture)
        address = _pictures.address_of(arrays[0]) if arrays else 0
        self._warn_if_reused(arrays, address)
        frame = ffi.new('L1L2StabFrame *')
        _pictures.point_to(frame, arrays)
        frame.struct_size = ffi.sizeof('L1L2StabFrame')
        frame.pts = _NO_PTS if pts is None else pts
        frame.flags = lib.L1L2STAB_FRAME_DISCONT if discontinuity else 0
        frame.release = lib.l1l2stab_python_release
        given = None
        if motion is not None:
            matrix = np.asarray(motion, float)
            if matrix.shape != (3, 3):
                raise ValueError(f'motion has the shape {matrix.shape}, not (3, 3)')
            given = frame.motion = ffi.new('double[9]', matrix.ravel().tolist())
        held = _library.Held(self._stream, arrays, address, isinstance(picture, np.ndarray), tag)
        with self._lock:
            instance = self._open()
            frame.opaque = held.hold()
            result = lib.l1l2stab_push(instance, frame)
            lines = self._stream.settle()
            if result == lib.L1L2STAB_OK:
                self._held += 1
            else:
                held.drop()
        del given
        self._stream.report(lines, result)
        if result == lib.L1L2STAB_AGAIN:
            raise _library.state_error(f'{self._held} frames are held, as many as the window has: pull first')

    def _warn_if_reused(self, arrays: list[np.ndarray], address: int) -> None:
        if arrays and not self._warned and address in self._stream.addresses and arrays[0].flags.writeable:
            self._warned = True
            warnings.warn('this array was pushed before and is still read: if it has been filled again, push copies',
                          RuntimeWarning, stacklevel=_callers_level())

    def pull(self, out: Optional[Picture] = None, *, render: bool = True) -> Optional[Output]:
        """The oldest frame that is ready, or None if more has to be pushed first, or if all have been pulled.

        out: the array, or tuple of planes, to render into; None: new arrays
        render: False: no picture, only the numbers
        """
        with self._lock:
            output, lines, result = self._pull(out, render)
        self._stream.report(lines, result)
        return output

    def _pull(self, out: Optional[Picture], render: bool) -> tuple[Optional[Output], list[tuple[int, str]], int]:
        """pull() under the lock: the output, the log lines and the result."""
        pts, opaque = ffi.new('int64_t *'), ffi.new('void **')
        if lib.l1l2stab_peek(self._open(), pts, opaque) != lib.L1L2STAB_OK:
            return None, [], lib.L1L2STAB_AGAIN
        held = _library.Held.of(opaque[0])
        frame, info = ffi.new('L1L2StabFrame *'), ffi.new('L1L2StabInfo *')
        frame.struct_size = ffi.sizeof('L1L2StabFrame')
        if render:
            packed = held.packed if out is None else isinstance(out, np.ndarray)
            shape = _pictures.Shape(self._shape.layout, *self._output_size, packed)
            out = _pictures.empty(shape) if out is None else out
            planes = _pictures.planes_of(shape, out, writable=True)
            _pictures.point_to(frame, planes)
        result = lib.l1l2stab_pull(self._open(), frame if render else ffi.NULL, info)
        lines = self._stream.settle()
        if result != lib.L1L2STAB_OK:
            return None, lines, result
        self._held -= 1
        output = Output(out if render else None, _info_of(info), None if pts[0] == _NO_PTS else pts[0], held.tag)
        return output, lines, result

    def ready(self, out: Optional[Picture] = None, *, render: bool = True) -> Iterator[Output]:
        """Pulls the frames that are ready, one after the other."""
        while (output := self.pull(out, render=render)) is not None:
            yield output

    def border_map(self) -> np.ndarray:
        """Who gave each pixel of the picture that was pulled last: an array of uint8 of its rows and columns. 0: the
        frame itself; 128 + k: the frame k frames later (before, if k < 0); 255: it was made up. Needs border='fill' or
        'extend'."""
        width, height = self._output_size
        made = np.empty((height, width), np.uint8)
        self._call(lib.l1l2stab_border_map, ffi.from_buffer('uint8_t[]', made, require_writable=True), width)
        return made

    def finish(self) -> None:
        """Ends the input: all held frames can be pulled, and reset() makes push() possible again."""
        self._call(lib.l1l2stab_finish)

    def hurry(self, frames: int) -> None:
        """For a source that is late: the `frames` oldest held frames can be pulled from now on."""
        self._call(lib.l1l2stab_hurry, frames)

    def reset(self) -> None:
        """Drops all held frames and starts anew, with the settings as they were set last."""
        self._call(lib.l1l2stab_reset)
        self._held = 0

    def take_error(self) -> Optional[_library.Error]:
        """The first error of measuring a frame since the last call, or None. Such a frame is not lost: a path starts
        there, and its info has motion_failed."""
        try:
            self._call(lib.l1l2stab_take_error)
        except _library.Error as error:
            return type(error)(error.result, self._stream.last_error)
        return None

    def close(self) -> None:
        """Frees all memory. Held frames are dropped. Leaving a `with` block and the garbage collector do the same."""
        with self._lock:
            self._close()
            self._held = 0

    def _open(self) -> Any:
        if not self._close.alive:
            raise _library.state_error('the stabilizer is closed')
        return self._instance[0]

    def _call(self, function: Any, *arguments: Any) -> int:
        """Calls a function of the library with this instance. Returns its result, or raises the error that it is."""
        with self._lock:
            result = int(function(self._open(), *arguments) or 0)
            lines = self._stream.settle()
        self._stream.report(lines, result)
        return result
