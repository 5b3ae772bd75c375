"""Time slices by hand: by priority, and what one cannot use."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.policies.shared.times.time_slices import divide_time


def test_slices_go_by_priority() -> None:
    """Families of 12 and 5 ms: priorities 1, 2 and 3, and one alone."""
    parent, share_ms = np.array([0, 0, 0, 1]), np.array([12.0, 5.0])
    slices = divide_time(parent, share_ms, np.array([1.0, 2.0, 3.0, 7.0]), None)
    assert slices.tolist() == [2.0, 4.0, 6.0, 5.0]


def test_what_one_cannot_use_goes_to_the_others() -> None:
    """Of 12 ms the last can use 3, so that the others share 9 as 1 to 2; then one is full, too."""
    parent, share_ms, priority = np.zeros(3, dtype=int), np.array([12.0]), np.array([1.0, 2.0, 3.0])
    assert divide_time(parent, share_ms, priority, np.array([9.0, 9.0, 3.0])).tolist() == [3, 6, 3]
    assert divide_time(parent, share_ms, priority, np.array([9.0, 4.0, 3.0])).tolist() == [5, 4, 3]
    assert divide_time(parent, share_ms, priority, np.array([1.0, 4.0, 3.0])).tolist() == [1, 4, 3]


def test_a_family_without_time_has_none() -> None:
    """A negative share, of a node that took more than its slice itself, is none."""
    slices = divide_time(np.zeros(2, dtype=int), np.array([-1.0]), np.ones(2), np.ones(2))
    assert slices.tolist() == [0.0, 0.0]


@given(
    family=st.lists(
        st.tuples(st.floats(0.01, 10.0), st.floats(0.01, 10.0)), min_size=1, max_size=12
    ),
    share_ms=st.floats(0.0, 60.0),
)
def test_all_time_is_given_out_that_can_be_used(
    family: list[tuple[float, float]], share_ms: float
) -> None:
    """Slices sum to the share, or to what all can use; those below their most go by priority."""
    priority, most_ms = np.array(family).T
    slices = divide_time(np.zeros(len(family), dtype=int), np.array([share_ms]), priority, most_ms)
    assert (slices <= most_ms).all()
    assert slices.sum() == pytest.approx(min(share_ms, most_ms.sum()))
    rate = slices / priority
    below = slices < most_ms * (1.0 - 1e-12)
    if below.any():
        assert np.ptp(rate[below]) <= 1e-9 * rate[below].max()
        assert rate[~below].max(initial=0.0) <= rate[below].max() * (1.0 + 1e-9)
