"""A capture's times and an engine's counts, joined by time."""

from dataclasses import replace

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.join_logs import join_by_time
from lodbench.traces.logs.render_log import RenderLog


def pair(
    offset_s: float = 0.0, *, own_times: bool = False, every: int = 1
) -> tuple[RenderLog, RenderLog]:
    """Make a capture of 600 frames, and counts of them by a clock that is off by some seconds."""
    rng = np.random.default_rng(5)
    triangles = rng.uniform(2e5, 3e6, 600)
    frame_ms = 4.0 + 3e-6 * triangles
    clock = np.cumsum(frame_ms) / 1e3
    nothing = np.empty((600, 0))
    times = RenderLog("pm", "presentmon", (), nothing, frame_ms=frame_ms, time_s=clock)
    rows = slice(40, 500, every)
    jitter = rng.normal(0.0, 2e-4, 600)
    counts = RenderLog(
        "engine",
        "csv",
        ("triangles",),
        triangles[rows, np.newaxis],
        frame_ms=frame_ms[rows] if own_times else None,
        time_s=(clock + jitter - offset_s)[rows],
    )
    return times, counts


def slope(log: RenderLog) -> float:
    """Return the ns a triangle that a joined log says."""
    return 1e6 * float(np.polyfit(log.counts[:, 0], log.time("frame_ms"), 1)[0])


@pytest.mark.parametrize("every", [1, 7])
def test_logs_of_one_clock_join_by_it(every: int):
    """Every row of counts finds its frame, also where only every seventh was logged."""
    joined = join_by_time(*pair(every=every))
    assert len(joined) == len(range(40, 500, every))
    assert slope(joined) == pytest.approx(3.0, rel=0.01)
    assert "on one clock" in joined.notes[-1]


@pytest.mark.parametrize("offset_s", [1.37, -2.6, 5_000.0])
def test_frame_times_find_how_far_clocks_are_apart(offset_s: float):
    """Where the engine logged its own frame times, the shift is found, whatever the clocks say."""
    joined = join_by_time(*pair(offset_s, own_times=True))
    assert len(joined) >= 450
    assert slope(joined) == pytest.approx(3.0, rel=0.01)
    assert "by their frame times" in joined.notes[-1]


def test_without_a_sign_the_beginnings_are_taken_and_that_is_said():
    """Clocks of different epochs are laid together at their first rows."""
    times, counts = pair(5_000.0)
    joined = join_by_time(times, counts)
    assert "taken to begin together" in joined.notes[-1]


def test_what_cannot_be_joined_is_refused():
    """No clock, and no counts."""
    times, counts = pair()
    with pytest.raises(InputError, match="expected a clock to join by"):
        join_by_time(replace(times, time_s=None), counts)
    with pytest.raises(InputError, match="expected counts to join"):
        join_by_time(times, times)
