# SPDX-License-Identifier: MIT
"""Calls of the C library: its errors as exceptions, its log lines, and the objects that it holds.

The library keeps a pointer to each pushed frame until it calls release(). Meanwhile `Held` keeps the arrays alive.
cffi releases the GIL during each call. The library logs and releases on the thread of the call. What happens there is
only noted down, and is acted on after the call: then the lock of the stabilizer is no longer held.
"""
from __future__ import annotations

import itertools
import logging
import re
from typing import Any

from ._cffi import ffi, lib

logger = logging.getLogger('l1l2stab')

# By L1L2StabLogLevel. Python has no level for what is logged for each frame.
_LEVELS = {lib.L1L2STAB_LOG_ERROR: logging.ERROR, lib.L1L2STAB_LOG_WARN: logging.WARNING,
           lib.L1L2STAB_LOG_INFO: logging.INFO, lib.L1L2STAB_LOG_DEBUG: logging.DEBUG, lib.L1L2STAB_LOG_TRACE: 5}


class Error(Exception):
    """An error of the library. Its text is the library's own log line, where there is one.

    result: the number that the C function returned, such as -1
    log: the log line, or '' if the library wrote none
    """

    def __init__(self, result: int, log: str = '') -> None:
        super().__init__(log or ffi.string(lib.l1l2stab_strerror(result)).decode())
        self.result = result
        self.log = log


class ArgumentError(Error, ValueError):
    """The caller's fault: a value out of range. The text says which range it has."""


class StateError(Error, RuntimeError):
    """The caller's fault: a call out of order, such as push() after finish()."""


class UnsupportedError(Error, NotImplementedError):
    """Valid, but not supported. The text says what is supported."""


class OutOfMemoryError(Error, MemoryError):
    """The system is out of memory."""


class BackendError(Error, RuntimeError):
    """The library's fault: OpenCV or the solver failed."""


_ERRORS = {lib.L1L2STAB_ERR_ARGUMENT: ArgumentError, lib.L1L2STAB_ERR_STATE: StateError,
           lib.L1L2STAB_ERR_UNSUPPORTED: UnsupportedError, lib.L1L2STAB_ERR_NOMEM: OutOfMemoryError,
           lib.L1L2STAB_ERR_BACKEND: BackendError}


def state_error(text: str) -> StateError:
    return StateError(lib.L1L2STAB_ERR_STATE, text)


class Stream:
    """What the callbacks of one instance note down."""

    def __init__(self) -> None:
        self.lines: list[tuple[int, str]] = []  # log lines: level of the library, text
        self.released: list[Held] = []
        self.addresses: dict[int, int] = {}  # of the pictures that are held: how often
        self.last_error = ''  # the last error that was logged and not raised

    def settle(self) -> list[tuple[int, str]]:
        """Forgets what was released, and returns the new log lines."""
        lines, self.lines = self.lines, []
        self.released.clear()
        return lines

    def report(self, lines: list[tuple[int, str]], result: int) -> None:
        """Passes log lines to Python's logging, and raises the error of a result < 0."""
        error = ''
        for level, text in lines:
            if level == lib.L1L2STAB_LOG_ERROR and result < 0:
                error = text
                continue
            if level == lib.L1L2STAB_LOG_ERROR:
                self.last_error = text
            logger.log(_LEVELS[level], '%s', text)
        if result < 0:
            raise _ERRORS.get(result, Error)(result, error)


class Held:
    """A frame that the library holds: what must live until it is released, and what pull() returns with it."""

    _all: dict[int, Held] = {}
    _numbers = itertools.count(1)

    def __init__(self, stream: Stream, arrays: list[Any], address: int, packed: bool, tag: Any) -> None:
        self.stream = stream
        self.arrays = arrays
        self.address = address  # of the first plane; 0 if there is none
        self.packed = packed  # one array for all planes
        self.tag = tag
        self.number = next(self._numbers)

    def hold(self) -> Any:
        """The pointer by which the library knows the frame."""
        self._all[self.number] = self
        self.stream.addresses[self.address] = self.stream.addresses.get(self.address, 0) + 1
        return ffi.cast('void *', self.number)

    def drop(self) -> None:
        del self._all[self.number]
        self.stream.addresses[self.address] -= 1
        if not self.stream.addresses[self.address]:
            del self.stream.addresses[self.address]

    @classmethod
    def of(cls, opaque: Any) -> Held:
        return cls._all[int(ffi.cast('uintptr_t', opaque))]


@ffi.def_extern()
def l1l2stab_python_log(cookie: Any, level: int, message: Any) -> None:
    ffi.from_handle(cookie).lines.append((level, ffi.string(message).decode(errors='replace')))


@ffi.def_extern()
def l1l2stab_python_release(opaque: Any) -> None:
    held = Held.of(opaque)
    held.drop()
    held.stream.released.append(held)


def max_level() -> int:
    """The most verbose level of the library that Python's logging wants."""
    wanted = logger.getEffectiveLevel()
    return max((level for level, number in _LEVELS.items() if number >= wanted), default=lib.L1L2STAB_LOG_ERROR)


def constants(enumeration: str) -> dict[str, int]:
    """The values of an enumeration of the header by their short names: {'bilinear': 0, 'bicubic': 1, ...}."""
    name = enumeration.split()[-1].replace('L1L2Stab', 'L1L2STAB_', 1)  # a field's type is called 'enum L1L2Stab...'
    prefix = re.sub(r'(?<=[a-z])(?=[A-Z])', '_', name).upper() + '_'
    values = sorted(ffi.typeof(enumeration).relements.items(), key=lambda item: item[1])
    return {constant[len(prefix):].lower(): value for constant, value in values}
