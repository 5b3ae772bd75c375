"""Memory that the process has once, it keeps, so that no frame pays for taking it back."""

import ctypes

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # parameters of glibc's mallopt
_MOST = 2**31 - 1


def keep_memory() -> bool:
    """Have the allocator keep what is freed; return whether it can be told to, as glibc's can.

    Left to itself, glibc gives memory back to the system where much is free at the end of the
    heap.  Mesa's rasteriser frees a frame's triangles at its end, so that above some 75,000 to
    160,000 triangles (by the largest mesh drawn before) every frame takes its pages back one fault
    at a time: a step of up to 100 ns a triangle, in which no count of what is drawn has a part.
    """
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):  # another C library
        return False
    return all(mallopt(name, _MOST) == 1 for name in (_TRIM_THRESHOLD, _MMAP_THRESHOLD))
