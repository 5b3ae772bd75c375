"""Series short enough to draw keep what matters of them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.report.series import envelope, stairs, tail, thinned


def test_envelope_keeps_extremes_and_ends_of_short_lines() -> None:
    """A short line is untouched; of a long one every bucket keeps its lowest and highest."""
    x = np.arange(1000.0)
    y = np.sin(x)
    y[517] = 40.0
    assert [part.tolist() for part in envelope(x[:20], y[:20], 10)] == [
        x[:20].tolist(),
        y[:20].tolist(),
    ]
    few_x, few_y = envelope(x, y, 50)
    assert len(few_x) <= 100
    assert 40.0 in few_y
    assert (np.diff(few_x) > 0).all()


@given(st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=300), st.integers(1, 20))
def test_envelope_keeps_the_range(values: list[float], buckets: int) -> None:
    """Whatever is left out, the lowest and the highest value stay."""
    y = np.array(values)
    _, few = envelope(np.arange(len(y), dtype=np.float64), y, buckets)
    assert (few.min(), few.max()) == (y.min(), y.max())
    assert len(few) <= max(2 * buckets, len(y) if len(y) <= 2 * buckets else 0)


def test_tail_by_hand() -> None:
    """All time is in frames of the shortest at least, and half in the longest, which lasts so long.

    A frame that is never shown has no interval, and one that weighs nothing no time.
    """
    values = np.array([3.0, 1.0, np.nan, 2.0, 9.0, 7.0])
    x, share = tail(values, np.array([1.0, 1.0, 5.0, 1.0, 3.0, 0.0]), 100)
    assert x.tolist() == [1.0, 2.0, 3.0, 9.0]
    assert share == pytest.approx([1.0, 5 / 6, 4 / 6, 0.5])


def test_tail_is_thinned_in_its_body_only() -> None:
    """Of 10,000 frames the slowest twentieth is drawn in full."""
    x, share = tail(np.arange(10_000.0), np.ones(10_000), 100)
    assert len(x) <= 601
    assert x[-500:].tolist() == np.arange(9_500.0, 10_000.0).tolist()
    assert share[-1] == pytest.approx(1e-4)


def test_stairs_and_thinning_by_hand() -> None:
    """A step falls at its value and goes on to the next; few values stay, of many both ends."""
    x, y = stairs(np.array([1.0, 2.0, 4.0]), np.array([1.0, 0.5, 0.25]))
    assert x.tolist() == [1.0, 1.0, 2.0, 2.0, 4.0]
    assert y.tolist() == [1.0, 0.5, 0.5, 0.25, 0.25]
    assert thinned(np.arange(3.0), 5).tolist() == [0.0, 1.0, 2.0]
    assert thinned(np.arange(100.0), 3).tolist() == [0.0, 49.0, 99.0]
