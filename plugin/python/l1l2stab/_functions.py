# SPDX-License-Identifier: MIT
"""Functions on whole sequences: stabilize(), measure(), smooth(), and pixel_matrix() for matrices."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Iterable, Iterator, Optional, Union

import numpy as np

from . import _pictures
from ._pictures import Picture, PictureT, Shape
from ._settings import Settings, check_settings
from ._stabilizer import Info, Stabilizer

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Unpack

# Of measure(): the measured motion does not depend on the window, the memory does.
_MEASURE_WINDOW = 16


@dataclass(frozen=True, eq=False)
class Motion:
    """The measured motion of a frame, for smooth().

    matrix: (3, 3) float64: from this frame to the one before, pixels, origin at the frame's center
    path_start: this frame does not continue the one before: the first frame, or a cut. The matrix is the identity
    source, quality: as in Info
    """
    matrix: np.ndarray
    path_start: bool
    source: str
    quality: float


def _open(shape: Shape, fps: float, settings: Settings) -> Stabilizer:
    return Stabilizer(shape.width, shape.height, shape.layout.format, fps, **settings)


def _raise_error(stabilizer: Stabilizer) -> None:
    error = stabilizer.take_error()
    if error:
        raise error


def stabilize(frames: Iterable[PictureT], fps: float = 0, *, format: Optional[str] = None,
              out: Optional[Picture] = None, **settings: Unpack[Settings]) -> Iterator[PictureT]:
    """Yields the stabilized frames, as many as there are frames, in order.

        for frame in l1l2stab.stabilize(frames, fps=30, lambda_=0.5):
            ...

    frames: numpy arrays, or tuples of one array a plane. A frame must not be changed before its stabilized frame has
        been yielded, so each has to be an array of its own. If the size changes, a new path starts.
    fps: frames a second, [0, 1000]; 0: unknown, taken as 30
    format: one of FORMATS; None: guessed from the shape. (height, width): GRAY8; (height, width, 3): BGR;
        (height, width, 4): BGRA; three planes: I420, Y42B or Y444; two planes: NV12. Only the brightness in which the
        motion is measured depends on the order of the colors, so RGB frames can be taken for BGR ones with little harm.
    out: an array or tuple of planes to render into, again and again; None: each frame is a new array
    settings: see Settings

    The first frame comes when `window` frames have been read, and so many are held.
    """
    check_settings(fps, settings)
    return _stabilize(frames, fps, format, out, settings)


def _stabilize(frames: Iterable[PictureT], fps: float, format: Optional[str], out: Optional[Picture],
               settings: Settings) -> Iterator[PictureT]:
    stabilizer: Optional[Stabilizer] = None
    shape: Optional[Shape] = None
    try:
        for frame in frames:
            new_shape = _pictures.shape_of(frame, format)
            if stabilizer is None or new_shape != shape:
                if stabilizer is not None:
                    yield from _rest(stabilizer, out)
                    stabilizer.close()
                stabilizer, shape = _open(new_shape, fps, settings), new_shape
            stabilizer.push(frame)
            yield from _ready(stabilizer, out)
        if stabilizer is not None:
            yield from _rest(stabilizer, out)
    finally:
        if stabilizer is not None:
            stabilizer.close()


def _ready(stabilizer: Stabilizer, out: Optional[Picture]) -> Iterator[Any]:
    for output in stabilizer.ready(out):
        yield output.picture


def _rest(stabilizer: Stabilizer, out: Optional[Picture]) -> Iterator[Any]:
    """The held frames; then the error of a frame that could not be measured, if there was one."""
    stabilizer.finish()
    yield from _ready(stabilizer, out)
    _raise_error(stabilizer)


def measure(frames: Iterable[Picture], fps: float = 0, *, format: Optional[str] = None,
            **settings: Unpack[Settings]) -> Iterator[Motion]:
    """Yields the measured motion of each frame. Nothing is rendered.

    frames, fps, format: as in stabilize(); all frames must have the same size
    settings: see Settings. The default of `window` is 16 here: so many frames are held.
    """
    settings = {'window': _MEASURE_WINDOW, **settings}
    check_settings(fps, settings)
    return _measure(frames, fps, format, settings)


def _measure(frames: Iterable[Picture], fps: float, format: Optional[str], settings: Settings) -> Iterator[Motion]:
    def motions(stabilizer: Stabilizer) -> Iterator[Motion]:
        for output in stabilizer.ready(render=False):
            info = output.info
            yield Motion(info.F, info.path_start, info.source, info.quality)

    frames = iter(frames)
    first = next(frames, None)
    if first is None:
        return
    with _open(_pictures.shape_of(first, format), fps, settings) as stabilizer:
        stabilizer.push(first)
        for frame in frames:
            stabilizer.push(frame)
            yield from motions(stabilizer)
        stabilizer.finish()
        yield from motions(stabilizer)
        _raise_error(stabilizer)


def smooth(motions: Iterable[Union[Motion, ArrayLike]], width: int, height: int, fps: float = 0,
           **settings: Unpack[Settings]) -> Iterator[Info]:
    """Yields an Info for each motion: B is the update transform, `warp` the map that renders the frame. No pictures are
    needed. The result is that of stabilize(), to the bit, but for the rolling-shutter correction, which is not made.

    motions: what measure() yields, or (3, 3) matrices: from each frame to the one before, pixels, origin at the frame's
        center. The first one is not used.
    width, height: of the frames, pixels
    settings: see Settings
    """
    check_settings(fps, settings)
    return _smooth(motions, width, height, fps, settings)


def _smooth(motions: Iterable[Union[Motion, ArrayLike]], width: int, height: int, fps: float,
            settings: Settings) -> Iterator[Info]:
    with Stabilizer(width, height, 'GRAY8', fps, **settings) as stabilizer:
        for motion in motions:
            if isinstance(motion, Motion):
                stabilizer.push(None, motion=motion.matrix, discontinuity=motion.path_start)
            else:
                stabilizer.push(None, motion=motion)
            for output in stabilizer.ready(render=False):
                yield output.info
        stabilizer.finish()
        for output in stabilizer.ready(render=False):
            yield output.info


def pixel_matrix(matrix: np.ndarray, input_size: tuple[int, int],
                 output_size: Optional[tuple[int, int]] = None) -> np.ndarray:
    """A matrix such as Info.warp for positions in arrays: the center of the first pixel is at (0, 0).

        matrix = l1l2stab.pixel_matrix(info.warp, (width, height))
        cv2.warpPerspective(frame, matrix, (width, height), flags=cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP)

    matrix: (3, 3), from the output to the input, pixels, origins at the centers
    input_size, output_size: (width, height), pixels; the output has the input's size by default
    """
    def shift(size: tuple[int, int], sign: int) -> np.ndarray:
        return np.array([[1, 0, sign * (size[0] - 1) / 2], [0, 1, sign * (size[1] - 1) / 2], [0, 0, 1]])

    return np.asarray(shift(input_size, 1) @ matrix @ shift(output_size or input_size, -1))
