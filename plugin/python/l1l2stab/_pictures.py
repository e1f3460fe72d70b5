# SPDX-License-Identifier: MIT
"""Pictures as numpy arrays: which format an array has, and where its planes are in memory."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Optional, Sequence, TypeVar, Union

import numpy as np

from ._cffi import ffi, lib

Picture = Union[np.ndarray, Sequence[np.ndarray]]
PictureT = TypeVar('PictureT', np.ndarray, Sequence[np.ndarray])  # frames come out as they go in

# A plane: components, and the shifts by which its width and height are smaller than the picture's.
_FULL = {n: (n, 0, 0) for n in (1, 2, 3, 4)}
_HALF = {n: (n, 1, 1) for n in (1, 2)}
_HALF_WIDE = {n: (n, 1, 0) for n in (1, 2)}

# The planes of the formats: those with components of 8 bits, and those with components of two bytes.
_PLANES = [
    ([_FULL[1]], 'GRAY8', 'GRAY16_LE'),
    ([_FULL[3]], 'BGR RGB', ''),
    ([_FULL[4]], 'BGRA RGBA ARGB ABGR BGRX RGBX XRGB XBGR AYUV VUYA',
     'BGRA64_LE RGBA64_LE ARGB64_LE ABGR64_LE AYUV64'),
    ([_FULL[1], _HALF[1], _HALF[1]], 'I420 YV12', 'I420_10LE I420_12LE'),
    ([_FULL[1], _HALF_WIDE[1], _HALF_WIDE[1]], 'Y42B', 'I422_10LE I422_12LE'),
    ([_FULL[1], (1, 2, 0), (1, 2, 0)], 'Y41B', ''),
    ([_FULL[1]] * 3, 'Y444 GBR', 'Y444_10LE Y444_12LE Y444_16LE GBR_10LE GBR_12LE'),
    ([_FULL[1], _HALF[2]], 'NV12 NV21', 'P010_10LE P012_LE P016_LE'),
    ([_FULL[1], _HALF_WIDE[2]], 'NV16 NV61', ''),
    ([_FULL[1], _FULL[2]], 'NV24', ''),
    ([_FULL[1], _HALF[1], _HALF[1], _FULL[1]], 'A420', 'A420_10LE'),
    ([_FULL[1], _HALF_WIDE[1], _HALF_WIDE[1], _FULL[1]], '', 'A422_10LE'),
    ([_FULL[1], _HALF[2], _FULL[1]], 'AV12', ''),
    ([_FULL[1]] * 4, 'GBRA', 'A444_10LE GBRA_10LE GBRA_12LE'),
    # Packed 4:2:2 has two components a pixel here: U and V alternate.
    ([_FULL[2]], 'YUY2 UYVY YVYU VYUY', ''),
]


@dataclass(frozen=True)
class Layout:
    """How a format's samples lie in arrays."""
    format: str
    number: int  # L1L2StabFormat
    dtype: np.dtype
    planes: tuple[tuple[int, int, int], ...]

    def plane_shapes(self, width: int, height: int) -> list[tuple[int, ...]]:
        """The shape of each plane. Sizes are rounded up."""
        shapes: list[tuple[int, ...]] = []
        for components, right, down in self.planes:
            rows, columns = -(-height >> down), -(-width >> right)
            shapes.append((rows, columns) if components == 1 else (rows, columns, components))
        return shapes


LAYOUTS = {
    name: Layout(name, getattr(lib, 'L1L2STAB_FORMAT_' + name), np.dtype(dtype), tuple(planes))
    for planes, *names in _PLANES for dtype, line in zip(('u1', '<u2'), names) for name in line.split()
}

#: The names of all formats, for the argument `format`.
FORMATS = tuple(LAYOUTS)


def layout_named(name: str) -> Layout:
    try:
        return LAYOUTS[name.upper()]
    except KeyError:
        raise ValueError(f'there is no format {name!r}: choose one of {", ".join(FORMATS)}') from None


@dataclass(frozen=True)
class Shape:
    """What is the same for all pictures of a stream."""
    layout: Layout
    width: int
    height: int
    packed: bool = True  # a picture is one array, not a sequence of one array a plane


def _packed_guess(picture: np.ndarray) -> str:
    components = 1 if picture.ndim == 2 else picture.shape[2] if picture.ndim == 3 else 0
    guesses = {('u1', 1): 'GRAY8', ('u1', 3): 'BGR', ('u1', 4): 'BGRA', ('u2', 1): 'GRAY16_LE', ('u2', 4): 'BGRA64_LE'}
    guess = guesses.get((picture.dtype.str[1:], components))
    if not guess:
        raise ValueError(f'no format has {picture.dtype} arrays of the shape {picture.shape}: give uint8 arrays of the '
                         'shape (height, width), (height, width, 3) or (height, width, 4), or name the format')
    return guess


def _planes_guess(planes: Sequence[np.ndarray]) -> str:
    height, width = planes[0].shape[:2]
    for name in ('I420', 'Y42B', 'Y444', 'NV12', 'A420'):
        shapes = LAYOUTS[name].plane_shapes(width, height)
        if len(shapes) == len(planes) and all(p.dtype == np.uint8 and p.shape[:2] == s[:2]
                                              for p, s in zip(planes, shapes)):
            return name
    raise ValueError('the format does not follow from the planes ' +
                     ', '.join(f'{p.dtype}{p.shape}' for p in planes) + ': name it')


def _packed_height(layout: Layout, picture: np.ndarray) -> int:
    """The height of a picture whose planes lie one after the other in one array."""
    width, total = int(picture.shape[-1]), picture.size
    height = round(total / (width * sum(c / (1 << right + down) for c, right, down in layout.planes)))
    if total != sum(math.prod(shape) for shape in layout.plane_shapes(width, height)):
        raise ValueError(f'an array of the shape {picture.shape} is no {layout.format} picture: give the planes as a '
                         'tuple of arrays, or one array whose last axis is the width')
    return height


def shape_of(picture: Any, format: Optional[str] = None) -> Shape:
    """The shape of a picture. Without a format it is guessed."""
    packed = isinstance(picture, np.ndarray)
    if not packed and not (isinstance(picture, (tuple, list)) and picture and
                           all(isinstance(plane, np.ndarray) and plane.ndim >= 2 for plane in picture)):
        raise TypeError(f'a frame is a numpy array or a tuple of one array a plane, not {type(picture).__name__}')
    if packed and (picture.ndim < 2 or not picture.size):
        raise ValueError(f'an array of the shape {picture.shape} is no picture')
    layout = layout_named(format or (_packed_guess(picture) if packed else _planes_guess(picture)))
    if packed and len(layout.planes) > 1:
        return Shape(layout, picture.shape[-1], _packed_height(layout, picture))
    height, width = (picture if packed else picture[0]).shape[:2]
    if layout.planes == (_FULL[2],) and width % 2:
        raise ValueError(f'{layout.format} pictures have an even width, not {width}')
    return Shape(layout, width, height, packed)


def empty(shape: Shape) -> Picture:
    """A new picture. Its samples are not set."""
    sizes = shape.layout.plane_shapes(shape.width, shape.height)
    if not shape.packed:
        return tuple(np.empty(size, shape.layout.dtype) for size in sizes)
    if len(sizes) == 1:
        return np.empty(sizes[0], shape.layout.dtype)
    total = sum(math.prod(size) for size in sizes)
    if total % shape.width:
        raise ValueError(f'{shape.layout.format} pictures of {shape.width}x{shape.height} do not fit in one array with '
                         'rows of that width: use a tuple of one array a plane')
    return np.empty((total // shape.width, shape.width), shape.layout.dtype)


def _split(layout: Layout, picture: np.ndarray, sizes: list[tuple[int, ...]]) -> list[np.ndarray]:
    """The planes of a picture in one array, as views."""
    if picture.size != sum(math.prod(size) for size in sizes):
        raise ValueError(f'an array of the shape {picture.shape} has not the size of a {layout.format} picture with '
                         f'planes of {sizes}')
    flat, planes, start = picture.reshape(-1), [], 0
    for size in sizes:
        stop = start + math.prod(size)
        planes.append(flat[start:stop].reshape(size))
        start = stop
    return planes


def _rows_are_dense(plane: np.ndarray) -> bool:
    """Whether the samples of a row lie side by side. Rows may lie anywhere."""
    step = plane.itemsize
    for size, stride in zip(plane.shape[:0:-1], plane.strides[:0:-1]):
        if size > 1 and stride != step:
            return False
        step *= size
    return True


def planes_of(shape: Shape, picture: Any, *, writable: bool = False) -> list[np.ndarray]:
    """The planes of a picture of this shape, each with dense rows. Views, if the picture's rows are dense; otherwise
    copies, or a ValueError if they are to be written to."""
    layout, sizes = shape.layout, shape.layout.plane_shapes(shape.width, shape.height)
    packed = isinstance(picture, np.ndarray)
    planes = [picture] if packed else list(picture)
    for plane in planes:
        if not isinstance(plane, np.ndarray) or plane.dtype != layout.dtype:
            kind = plane.dtype if isinstance(plane, np.ndarray) else type(plane).__name__
            raise TypeError(f'a {layout.format} picture has numpy arrays of {layout.dtype}, not {kind}')
        if writable and not plane.flags.writeable:
            raise ValueError('the array to write into is read-only')
    if packed and len(sizes) > 1:
        if writable and not picture.flags.c_contiguous:
            raise ValueError('the array to write into must be contiguous')
        planes = _split(layout, picture, sizes)
    if len(planes) != len(sizes):
        raise ValueError(f'a {layout.format} picture has {len(sizes)} planes, not {len(planes)}')
    for i, (plane, size) in enumerate(zip(planes, sizes)):
        # The components of a pixel may be an axis of their own or not.
        if plane.shape not in (size, (size[0], math.prod(size[1:]))):
            raise ValueError(f'a plane of a {shape.width}x{shape.height} {layout.format} picture has the shape {size}, '
                             f'not {plane.shape}')
        if not _rows_are_dense(plane):
            if writable:
                raise ValueError('in the array to write into, the samples of a row must lie side by side')
            planes[i] = np.ascontiguousarray(plane)
    return planes


def address_of(plane: np.ndarray) -> int:
    return int(plane.__array_interface__['data'][0])


def point_to(frame: Any, planes: list[np.ndarray]) -> None:
    """Sets data and stride of an L1L2StabFrame."""
    for i, plane in enumerate(planes):
        frame.data[i] = ffi.cast('uint8_t *', address_of(plane))
        frame.stride[i] = plane.strides[0]
