"""Fences: marks in the stream of commands by which the processor learns how far the device is."""

from ctypes import c_uint, c_uint64, c_void_p

from ....base.errors import InputError
from .gl_functions import Loader, gl_function

_GPU_COMMANDS_COMPLETE = 0x9117
_FLUSH = 0x1
_ALREADY_SIGNALED, _TIMEOUT_EXPIRED, _CONDITION_SATISFIED = 0x911A, 0x911B, 0x911C
_LONGEST_NS = 60_000_000_000


class Fences:
    """Sets fences and waits for them; each is waited for to its end once."""

    def __init__(self, load: Loader) -> None:
        self._set = gl_function(load, "glFenceSync", c_void_p, c_uint, c_uint)
        self._wait = gl_function(load, "glClientWaitSync", c_uint, c_void_p, c_uint, c_uint64)
        self._delete = gl_function(load, "glDeleteSync", None, c_void_p)
        self._flush = gl_function(load, "glFlush", None)

    def set(self) -> int:
        """Return a fence behind all commands so far, and have the driver begin with them."""
        fence: int = self._set(_GPU_COMMANDS_COMPLETE, 0)
        self._flush()
        return fence

    def reached(self, fence: int, *, wait: bool) -> bool:
        """Return whether the device has reached a fence, which is then gone.

        Raises `InputError` if it does not within a minute.

        Parameters
        ----------
        wait : until it is, instead of asking whether it is by now
        """
        state = int(self._wait(fence, _FLUSH, _LONGEST_NS if wait else 0))
        if state in {_ALREADY_SIGNALED, _CONDITION_SATISFIED}:
            self._delete(fence)
            return True
        if wait or state != _TIMEOUT_EXPIRED:
            raise InputError("expected the device to finish a frame within a minute, got none")
        return False
