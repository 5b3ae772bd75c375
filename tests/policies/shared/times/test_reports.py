"""Test which reported times are believed."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.models.scene.scene import Scene
from lodbench.policies.selection import Selection
from lodbench.policies.shared.times.reports import Reports
from lodbench.policies.view import View

NAN = float("nan")
TARGET_MS = 10.0
TRIANGLES = (1000.0, 995.0, 500.0, 250.0)  # by level; the first step is half a hundredth

Tell = Callable[..., list[int]]


@pytest.fixture(scope="module")
def tell(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., object],
    make_view: Callable[..., View],
) -> Tell:
    """Return a function of what frames took and drew that returns which are believed."""
    scene = make_scene([[0.0, 0.0, -5.0]], levels=make_levels((TRIANGLES,)))

    def told(
        times_ms: Sequence[float],
        levels: Sequence[int],
        *,
        gpu_ms: Sequence[float] | None = None,
        late: Sequence[int] = (),
    ) -> list[int]:
        """Let each report arrive one frame later than its own, and so many more as are given."""
        reports, believed, drawn, last = Reports(), list[int](), None, 0
        gpu_ms = times_ms if gpu_ms is None else gpu_ms
        for frame in range(len(times_ms) + 1):
            arrived = frame - (late[frame] if frame < min(len(late), len(times_ms)) else 0)
            last = max(last, arrived)
            view = make_view(scene, work_ms=gpu_ms[:last], frame=frame, previous=drawn)
            arrived_ms = np.array(times_ms[:last])
            believed += reports.new(view, arrived_ms, TARGET_MS)[0].tolist()
            if frame < len(levels):
                detail = np.array([float(levels[frame])])
                drawn = Selection(np.array([0], dtype=np.int32), detail)
        return believed

    return told


def test_each_report_is_read_once(tell: Tell) -> None:
    """Three reports are read in their order, one each."""
    assert tell([5.0, 6.0, 7.0], [0, 0, 0]) == [0, 1, 2]


def test_faulty_reports_are_no_times(tell: Tell) -> None:
    """Missing, zero, negative and infinite reports are dropped."""
    assert tell([NAN, 0.0, -1.0, np.inf, 4.0, NAN], [0] * 6) == [4]


def test_repeats_at_rest_are_honest(tell: Tell) -> None:
    """Where the same is drawn the same time is what a timer has to say, however often."""
    assert tell([4.0] * 6, [2] * 6) == [0, 1, 2, 3, 4, 5]


def test_three_equal_reports_of_changing_work_are_stuck(tell: Tell) -> None:
    """Of frames that draw 1000, 500, 250, 1000 triangles in 4 ms each the first two count."""
    assert tell([4.0, 4.0, 4.0, 4.0], [0, 2, 3, 0]) == [0, 1]


def test_stuck_until_another_time_is_told(tell: Tell) -> None:
    """A policy that rests because its timer is stuck does not believe it for resting."""
    assert tell([4.0, 4.0, 4.0, 4.0, 4.0, 5.0, 5.0], [0, 2, 3, 3, 3, 3, 3]) == [0, 1, 5, 6]


def test_stuck_timers_still_speak_against_detail(tell: Tell) -> None:
    """Above the target every report counts."""
    assert tell([12.0] * 4, [0, 2, 3, 0]) == [0, 1, 2, 3]


def test_what_a_timer_may_hide_is_no_change(tell: Tell) -> None:
    """1000 and 995 triangles, back and forth, may take the same time."""
    assert tell([4.0] * 4, [0, 1, 0, 1]) == [0, 1, 2, 3]


def test_a_steady_processor_does_not_make_a_timer_stuck(tell: Tell) -> None:
    """Work time that rests at the CPU's is honest where the GPU's time moves."""
    work_ms, levels = [4.0] * 4, [0, 2, 3, 0]
    assert tell(work_ms, levels, gpu_ms=[3.0, 2.0, 1.0, 3.0]) == [0, 1, 2, 3]


@given(
    frames=st.lists(
        st.tuples(st.sampled_from([NAN, 0.0, -2.0, 3.0, 4.0, 11.0]), st.integers(0, 3)),
        max_size=12,
    ),
    late=st.lists(st.integers(0, 4), max_size=12),
)
def test_reading_late_equals_reading_at_once(
    tell: Tell, frames: list[tuple[float, int]], late: list[int]
) -> None:
    """However the reports arrive, the same are believed."""
    times_ms, levels = [time for time, _ in frames], [level for _, level in frames]
    assert tell(times_ms, levels, late=late) == tell(times_ms, levels)
