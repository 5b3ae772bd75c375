"""Memory that is freed stays with the process that draws."""

import subprocess
import sys

import pytest

# A frame's worth of blocks as the rasteriser takes them, twice: faults of the second round.
ROUNDS = """
import ctypes, resource, sys
from lodbench.render.gl.process_memory import keep_memory

kept = sys.argv[1] == "kept" and keep_memory()
libc = ctypes.CDLL(None)
libc.malloc.restype, libc.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
libc.free.argtypes = [ctypes.c_void_p]
for _ in range(2):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    blocks = [libc.malloc(64 << 10) for _ in range(600)]
    for block in blocks:
        ctypes.memset(block, 1, 64 << 10)
    for block in blocks:
        libc.free(block)
print(kept, resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
"""


def faults(how: str) -> tuple[bool, int]:
    """Return whether memory was kept, and how many pages the second round took anew."""
    command = [sys.executable, "-c", ROUNDS, how]
    kept, count = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    return kept == "True", int(count)


@pytest.mark.skipif(sys.platform != "linux", reason="the allocator of glibc")
def test_the_second_frame_takes_no_page_anew() -> None:
    """38 MB freed and taken again cost some 9,600 faults if left alone, next to none if kept."""
    kept, count = faults("kept")
    if not kept:
        pytest.skip("another C library than glibc")
    assert count < 100
    assert faults("left alone")[1] > 5_000
