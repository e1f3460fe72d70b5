# SPDX-License-Identifier: MIT
"""The settings, and how they get into the library's config."""
from __future__ import annotations

from typing import Any, Literal, Optional, Sequence, TypedDict

import numpy as np

from ._cffi import ffi, lib
from . import _library
from ._pictures import Shape, layout_named


class Settings(TypedDict, total=False):
    """The settings of Stabilizer, stabilize(), measure() and smooth(), all of them keywords.

    lambda_: how closely the result follows the camera, [0, 1000], default 0.5: 0.1 is very smooth, 2 follows most of
        the shake. Python has a keyword of this name, hence the underscore.
    crop_ratio: shown part of each side, [0.5, 0.99], default 0.9. The rest is room for stabilization.
    window: frames that are optimized together, [4, 900], default 150. So many frames are held, and the first frame
        can be pulled when so many have been pushed.
    overlap: frames that two windows share, [3, window); 0, the default: chosen by `join`
    join: 'continuous' (default) or 'blend': how windows are joined
    interpolation: 'bilinear', 'bicubic' (default) or 'lanczos'
    output_size: 'input' (default): the crop window is zoomed to the size of the input; 'crop': its own size, rounded
        down to even numbers
    border: 'crop' (default): the crop window is shown; 'fill': the whole frame at its own scale, and neighboring frames
        fill what it lacks; 'extend': the same without neighbors, mirrored. crop_ratio is the room of the path
    fill_frames: with border='fill': neighbors are at most so many frames away, [0, 120], default 30. So many frames
        are kept after they have been pulled
    analysis_size: longer side of the picture in which the motion is measured, pixels, [128, 4096], default 640
    threads: threads that work, with the caller's, [0, 64]; 0, the default: one per core. Frames do not depend on it
    seed: of the random samples of RANSAC, default 1
    weights: of the first, second and third difference of the path, each (0, 1000], default (1, 1, 1)
    solver: 'auto' (default), 'checked', 'predictor' or 'osqp': for tests
    motion_model: 'translation', 'similarity' (default) or 'affine'
    rolling_shutter: 'none', 'homography' or 'mixture' (default): the correction of wobble and skew
    chroma_site: 'left' (default), 'center' or 'top_left': where chroma samples lie in subsampled formats
    pixel_aspect: a pixel's width by its height as it is shown, [0.1, 10], default 1
    region: (x, y, width, height) of the part of the frame in which the motion is measured, in parts of the frame's
        width and height, at least 1/8 wide and high; default (0, 0, 1, 1)
    mask: array (rows, columns) of bool or uint8, scaled to the frame: nothing is measured where it is 0
    """
    lambda_: float
    crop_ratio: float
    window: int
    overlap: int
    join: Literal['continuous', 'blend']
    interpolation: Literal['bilinear', 'bicubic', 'lanczos']
    output_size: Literal['input', 'crop']
    border: Literal['crop', 'fill', 'extend']
    fill_frames: int
    analysis_size: int
    threads: int
    seed: int
    weights: Sequence[float]
    solver: Literal['auto', 'checked', 'predictor', 'osqp']
    motion_model: Literal['translation', 'similarity', 'affine']
    rolling_shutter: Literal['none', 'homography', 'mixture']
    chroma_site: Literal['left', 'center', 'top_left']
    pixel_aspect: float
    region: Sequence[float]
    mask: Optional[np.ndarray]


_FIELDS = dict(ffi.typeof('L1L2StabConfig').fields)


def _value(name: str, field: Any, value: Any) -> Any:
    """A setting as the type of its field."""
    if field.kind == 'enum':
        choices = _library.constants(field.cname)
        if value not in choices:
            raise ValueError(f'{name} is {value!r}: choose one of ' + ', '.join(map(repr, choices)))
        return choices[value]
    if field.kind == 'array':
        value = list(value)
        if len(value) != field.length:
            raise ValueError(f'{name} has {len(value)} numbers: give {field.length}')
    return value


def _set_mask(config: Any, mask: Any) -> np.ndarray:
    """Returns the array that the config points to."""
    rows = np.ascontiguousarray(mask)
    if rows.ndim != 2 or rows.dtype not in (np.bool_, np.uint8):
        raise ValueError(f'mask is an array of {rows.dtype} and the shape {rows.shape}: give bool or uint8, two axes')
    config.mask = ffi.cast('const uint8_t *', rows.__array_interface__['data'][0])
    config.mask_stride = config.mask_width = rows.shape[1]
    config.mask_height = rows.shape[0]
    return rows


def make_config(stream: _library.Stream, shape: Shape, fps: float, settings: Settings) -> tuple[Any, list[Any]]:
    """The config, and what has to live as long as the instance that it is for. Log lines go to the stream."""
    config = ffi.new('L1L2StabConfig *')
    lib.l1l2stab_config_init(config, ffi.sizeof('L1L2StabConfig'))
    config.format, config.width, config.height = shape.layout.number, shape.width, shape.height
    config.frame_rate = float(fps)
    keep = [ffi.new_handle(stream)]
    config.logger.write = lib.l1l2stab_python_log
    config.logger.cookie = keep[0]
    config.logger.max_level = _library.max_level()
    for name, value in settings.items():
        if name not in Settings.__annotations__:
            raise TypeError(f'there is no setting {name!r}: the settings are ' + ', '.join(Settings.__annotations__))
        if name != 'mask':
            field = name.rstrip('_')
            setattr(config, field, _value(name, _FIELDS[field].type, value))
        elif value is not None:
            keep.append(_set_mask(config, value))
    return config, keep


def check_settings(fps: float, settings: Settings) -> None:
    """Raises what is wrong with the settings, whatever the size of the frames."""
    stream = _library.Stream()
    config, _keep = make_config(stream, Shape(layout_named('GRAY8'), 640, 360), fps, settings)
    delay = lib.l1l2stab_config_delay(config)
    stream.report(stream.settle(), delay)
