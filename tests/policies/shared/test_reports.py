"""Test which reported times are believed."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.shared.reports import Reports

NAN = float("nan")


def test_each_report_is_read_once() -> None:
    """Two reports, then one more, then none."""
    reports = Reports()
    times_ms = np.array([5.0, 6.0, 7.0])
    frames, new = reports.new(times_ms[:2], 10.0)
    assert (frames.tolist(), new.tolist()) == ([0, 1], [5.0, 6.0])
    frames, new = reports.new(times_ms, 10.0)
    assert (frames.tolist(), new.tolist()) == ([2], [7.0])
    assert np.isnan(reports.newest_ms(times_ms, 10.0))


def test_faulty_reports_are_no_times() -> None:
    """Missing, zero, negative and infinite reports are dropped."""
    times_ms = np.array([NAN, 0.0, -1.0, np.inf, 4.0, NAN])
    frames, new = Reports().new(times_ms, 10.0)
    assert (frames.tolist(), new.tolist()) == ([4], [4.0])


def test_a_repeated_report_only_speaks_against_detail() -> None:
    """Of two equal reports in a row both count above the target, below it the first alone."""
    frames, _ = Reports().new(np.array([4.0, 4.0, 12.0, 12.0]), 10.0)
    assert frames.tolist() == [0, 2, 3]


def test_repeats_are_seen_across_calls() -> None:
    """A report equal to the last one of an earlier call is a repeat too."""
    reports = Reports()
    times_ms = np.array([4.0, 4.0, 5.0])
    assert reports.newest_ms(times_ms[:1], 10.0) == 4.0
    assert np.isnan(reports.newest_ms(times_ms[:2], 10.0))
    assert reports.newest_ms(times_ms, 10.0) == 5.0


@given(
    times=st.lists(st.sampled_from([NAN, 0.0, -2.0, 3.0, 4.0, 11.0, 12.0]), max_size=12),
    cuts=st.lists(st.integers(0, 12), max_size=4),
)
def test_reading_in_parts_equals_reading_at_once(times: list[float], cuts: list[int]) -> None:
    """However the reports arrive, the same are believed."""
    times_ms = np.array(times, dtype=np.float64)
    whole = Reports().new(times_ms, 10.0)[0].tolist()
    reports = Reports()
    parts: list[int] = []
    for end in sorted([*(min(cut, len(times)) for cut in cuts), len(times)]):
        parts += reports.new(times_ms[:end], 10.0)[0].tolist()
    assert parts == whole
