"""The Pareto front against its definition."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from lodbench.analysis.verdict.pareto import pareto_front


def test_front_by_hand() -> None:
    """(1, 3), (3, 1) and (2, 2) trade off; (3, 3) is beaten; a copy stands beside its twin."""
    costs = np.array([[1.0, 3.0], [3.0, 1.0], [2.0, 2.0], [3.0, 3.0], [2.0, 2.0]])
    assert pareto_front(costs).tolist() == [True, True, True, False, True]


def test_incomplete_rows_are_on_no_front() -> None:
    """A policy without a value neither stands on the front nor pushes another off."""
    costs = np.array([[np.nan, 0.0], [1.0, 1.0]])
    assert pareto_front(costs).tolist() == [False, True]


@given(arrays(np.float64, (7, 3), elements=st.sampled_from([0.0, 1.0, 2.0])))
def test_front_equals_the_definition(costs: np.ndarray) -> None:
    """A row is on the front exactly if no row is as good everywhere and better somewhere."""
    expected = [
        not any(
            all(b <= a for a, b in zip(mine, other, strict=True))
            and any(b < a for a, b in zip(mine, other, strict=True))
            for other in costs
        )
        for mine in costs
    ]
    assert pareto_front(costs).tolist() == expected


@given(arrays(np.float64, (5, 4, 3), elements=st.floats(0.0, 1.0)))
def test_fronts_of_many_resamples_at_once(costs: np.ndarray) -> None:
    """Stacked tables give the fronts of each."""
    assert pareto_front(costs).tolist() == [pareto_front(table).tolist() for table in costs]
