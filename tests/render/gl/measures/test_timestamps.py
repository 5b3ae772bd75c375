"""Timestamps: the device's own word on when it was done, on the clock of who asks."""

import time
from ctypes import CFUNCTYPE, POINTER, c_int64, c_uint, c_void_p, cast
from typing import Any

from lodbench.render.gl.measures.fences import Fences
from lodbench.render.gl.measures.timestamps import Timestamps


def test_a_mark_is_reached_between_submission_and_fence(
    target: Any, drawing: Any, cube: Any
) -> None:
    """However late the caller looks; and marks are used again."""
    made, fences = drawing([(0.0, 0.0, -3.0)], [[cube()]]), Fences(target.load)
    stamps = Timestamps(target.load, time.perf_counter_ns)
    renderer = made.renderer()
    frame = renderer.prepare(made.picture())
    marks = set[int]()
    for _ in range(3):
        before_ns = time.perf_counter_ns()
        renderer.submit(frame, renderer.framebuffer(frame.size_px))
        marks.add(mark := stamps.mark())
        fences.reached(fences.set(), wait=True)
        seen_ns = time.perf_counter_ns()
        time.sleep(0.02)  # the caller looks much later
        assert before_ns <= stamps.reached_ns(mark) <= seen_ns
    assert len(marks) == 1


def test_the_device_s_clock_is_taken_to_the_caller_s(target: Any) -> None:
    """A device whose clock is 5 s ahead: what it says at 12 s was at 7 s."""
    now = [0]

    def clock() -> int:
        now[0] += 1_000
        return now[0]

    def device(_: int, value: Any) -> None:
        value[0] = now[0] + 500 + 5_000_000_000

    def result(_: int, __: int, value: Any) -> None:
        value[0] = 12_000_000_000

    kept = {
        "glGetInteger64v": CFUNCTYPE(None, c_uint, POINTER(c_int64))(device),
        "glGetQueryObjectui64v": CFUNCTYPE(None, c_uint, c_uint, POINTER(c_int64))(result),
    }

    def load(name: str) -> int:
        stub = kept.get(name)
        return target.load(name) if stub is None else int(cast(stub, c_void_p).value or 0)

    stamps = Timestamps(load, clock)
    assert stamps.reached_ns(stamps.mark()) == 7_000_000_000
