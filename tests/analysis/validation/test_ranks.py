"""Kendall's τ by counting pairs."""

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.validation.ranks import kendall_tau


@given(st.permutations(range(7)))
def test_tau_counts_pairs_in_order_against_pairs_out_of_order(order: list[int]) -> None:
    """Without ties τ is concordant minus discordant pairs over all."""
    signs = [1 if order[a] < order[b] else -1 for a, b in combinations(range(7), 2)]
    assert kendall_tau(list(range(7)), [float(x) for x in order]) == pytest.approx(
        sum(signs) / len(signs)
    )


def test_what_is_missing_is_left_out() -> None:
    """A pair that lacks one side does not count."""
    assert kendall_tau([1.0, 2.0, None, 3.0], [1.0, 2.0, 0.0, 3.0]) == pytest.approx(1.0)


def test_without_an_order_there_is_no_tau() -> None:
    """One pair, or equal values on one side, tell nothing."""
    assert kendall_tau([1.0], [1.0]) is None
    assert kendall_tau([1.0, 1.0, 1.0], [1.0, 2.0, 3.0]) is None
