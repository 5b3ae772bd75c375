"""When the device was done with what was handed to it, by its own clock.

A fence says so to who looks, and who prepares the next frame looks late: on llvmpipe 4 of 17 ms
late with two frames in flight.  Khronos, "ARB_timer_query", 2010; part of OpenGL 3.3.
"""

from collections.abc import Callable
from ctypes import POINTER, byref, c_int, c_int64, c_uint, c_uint64

from .gl_functions import Loader, gl_function

_TIMESTAMP, _RESULT = 0x8E28, 0x8866
_TRIES = 9  # readings of both clocks, of which the quickest counts


class Timestamps:
    """Marks in the stream of commands that note when they are reached, on the caller's clock.

    Both clocks are compared by `synchronise`: what they drift apart after it, some microseconds a
    second, is not known.

    Parameters
    ----------
    clock : of the caller, in nanoseconds
    """

    def __init__(self, load: Loader, clock: Callable[[], int]) -> None:
        self._clock, self._ahead_ns = clock, 0
        self._make = gl_function(load, "glGenQueries", None, c_int, POINTER(c_uint))
        self._mark = gl_function(load, "glQueryCounter", None, c_uint, c_uint)
        self._read = gl_function(
            load, "glGetQueryObjectui64v", None, c_uint, c_uint, POINTER(c_uint64)
        )
        self._now = gl_function(load, "glGetInteger64v", None, c_uint, POINTER(c_int64))
        self._free: list[int] = []
        self.synchronise()

    def synchronise(self) -> None:
        """Compare the device's clock with the caller's."""
        found, now = list[tuple[int, int]](), c_int64()
        for _ in range(_TRIES):
            before_ns = self._clock()
            self._now(_TIMESTAMP, byref(now))
            after_ns = self._clock()
            found.append((after_ns - before_ns, now.value - (before_ns + after_ns) // 2))
        self._ahead_ns = min(found)[1]

    def mark(self) -> int:
        """Return a mark behind all commands so far."""
        if self._free:
            query = self._free.pop()
        else:
            made = c_uint()
            self._make(1, byref(made))
            query = made.value
        self._mark(query, _TIMESTAMP)
        return query

    def reached_ns(self, mark: int) -> int:
        """Return when a mark was reached, on the caller's clock; the mark is then gone.

        The device has to be beyond it: else this waits.
        """
        value = c_uint64()
        self._read(mark, _RESULT, byref(value))
        self._free.append(mark)
        return value.value - self._ahead_ns
