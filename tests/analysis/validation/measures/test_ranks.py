"""Kendall's τ by counting pairs, and which pairs count."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.validation.measures.ranks import compare_pairs, kendall_tau, rank


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


def test_pairs_that_recordings_cannot_tell_apart_do_not_count() -> None:
    """Of policies at 10, 10.1 and 20 with repeats .2 apart, the first two are one."""
    measured = np.array([[10.0, 10.2], [10.1, 9.9], [20.0, 20.2]])
    pairs = compare_pairs(measured, np.tile([[11.0], [9.0], [15.0]], 40))
    assert pairs is not None
    assert pairs.apart.tolist() == [False, True, True]
    found = rank([pairs], 0.9)
    assert (found.simulated, found.apart, found.pairs) == (1.0, 2, 3)


def test_equal_policies_are_told_apart_in_one_of_twenty() -> None:
    """As often as is said, whatever the number of policies."""
    rng = np.random.default_rng(4)
    for count in (2, 5):
        apart = [
            compare_pairs(rng.normal(5.0, 1.0, (count, 2)), np.zeros((count, 3)))
            for _ in range(400)
        ]
        shares = [pairs.apart.mean() for pairs in apart if pairs is not None]
        assert np.mean(shares) == pytest.approx(0.05, abs=0.025)


def test_the_interval_is_that_of_the_replicates() -> None:
    """Where a third of the replicates reverse the order, τ of one lies from −1 to 1."""
    measured = np.array([[1.0, 1.0], [2.0, 2.0]])
    replicates = np.array([[1.0, 1.0, 3.0], [2.0, 2.0, 2.0]])
    pairs = compare_pairs(measured, replicates)
    assert pairs is not None
    found = rank([pairs, pairs], 0.9)
    assert found.pairs == found.apart == 2
    assert found.simulated == pytest.approx(1.0)  # of the means, 1.67 and 2
    assert found.low is not None
    assert found.low < 0.0
    assert found.high == pytest.approx(1.0)


def test_one_recording_tells_no_pair_apart() -> None:
    """Nobody knows then what it is off by; and one policy is no pair."""
    pairs = compare_pairs(np.array([[1.0], [2.0]]), np.ones((2, 3)))
    assert pairs is not None
    found = rank([pairs], 0.9)
    assert (found.simulated, found.apart, found.again) == (None, 0, None)
    assert compare_pairs(np.ones((1, 2)), np.ones((1, 3))) is None
