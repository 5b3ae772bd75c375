"""The reference: the same frame whatever is recorded, timed by the clock of the others."""

import time
from typing import Any

from lodbench.render.gl.measures.reference_draw import ReferenceDraw


def test_it_takes_the_median_of_three(target: Any) -> None:
    """By a clock that gains 1, 3, 5 ms from one reading to the next, the middle of three."""
    ticks_ms = iter(range(10**6))

    def clock() -> int:
        tick = next(ticks_ms)
        return 1_000_000 * tick * tick  # so that each drawing takes longer than the one before

    reference = ReferenceDraw(target, clock)
    first, again = reference.take_ms(), reference.take_ms()
    # A drawing reads the clock at t, t + 1 and t + 2, and so takes 4 t + 4 ms.
    assert again - first == 4.0 * 9
    assert first == 4.0 * (5 * 3 + 3) + 4.0  # five to warm up, then the second of three


def test_it_is_drawn_and_takes_time(target: Any) -> None:
    """More than nothing, and less than a second, of this thread."""
    assert 0.0 < ReferenceDraw(target, time.thread_time_ns).take_ms() < 1_000.0
