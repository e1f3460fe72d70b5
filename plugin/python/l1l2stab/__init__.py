# SPDX-License-Identifier: MIT
"""One-pass video stabilization of numpy frames, with L1-L2 optimal camera paths.

    import l1l2stab

    for frame in l1l2stab.stabilize(frames, fps=30):
        ...

stabilize(): stabilized frames of a sequence of frames
Stabilizer: the same step by step, with what was measured in each frame, and settings that can change meanwhile
measure(), smooth(): the motion of frames, and the smooth path for known motions, for pictures that others render
pixel_matrix(): the matrices of Info for cv2.warpPerspective() and the like
"""
from ._cffi import ffi as _ffi, lib as _lib
from ._functions import Motion, measure, pixel_matrix, smooth, stabilize
from ._library import ArgumentError, BackendError, Error, OutOfMemoryError, StateError, UnsupportedError
from ._pictures import FORMATS
from ._settings import Settings
from ._stabilizer import Info, Output, Stabilizer

__version__: str = _ffi.string(_lib.l1l2stab_version()).decode()


def simd() -> str:
    """The instruction set that the inner loops use on this processor: 'avx2', or 'none' for plain C."""
    return str(_ffi.string(_lib.l1l2stab_simd()).decode())


__all__ = [
    'ArgumentError', 'BackendError', 'Error', 'FORMATS', 'Info', 'Motion', 'Output', 'OutOfMemoryError', 'Settings',
    'StateError', 'Stabilizer', 'UnsupportedError', 'measure', 'pixel_matrix', 'simd', 'smooth', 'stabilize',
]
