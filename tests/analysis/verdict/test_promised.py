"""Promises about such paths: shares of time in two parts, times on their logarithm."""

from typing import Any

import numpy as np
import pytest
from scipy import stats

from lodbench.analysis.verdict.intervals import such_paths
from lodbench.analysis.verdict.promised import at_most

student: Any = stats.t
beta: Any = stats.beta


def test_no_miss_on_n_paths_is_no_promise_of_none() -> None:
    """On four clean paths up to 53 % of time may be missed; 299 clean ones promise 1 %."""
    few = at_most(np.zeros(4), "share", 0.01)
    assert few.high + 0.01 == pytest.approx(1.0 - 0.05**0.25)
    assert few.p == 1.0
    assert few.needed == 299
    assert at_most(np.zeros(298), "share", 0.01).high > 0.0
    assert at_most(np.zeros(299), "share", 0.01).high <= 0.0


def test_a_positive_time_is_judged_on_its_logarithm() -> None:
    """Student's t of ln(mean / limit), with the relative standard error; exact for two paths."""
    values = np.array([9.0, 11.0])
    relative = 2.0 / 100.0
    error = ((relative + relative**2 / 2) / 2) ** 0.5
    found = at_most(values, "positive", 20.0)
    assert found.p == pytest.approx(student.cdf(np.log(2.0) / error, 1))
    assert found.excess == -10.0
    known = such_paths(values, "positive", 0.9)
    assert known is not None
    assert found.high == pytest.approx(known.high - 20.0)


def test_p_and_interval_are_of_one_distribution() -> None:
    """At the upper 95 % end of a share's two parts p is .95, at its lower end .05."""
    values = np.array([0.0, 0.0, 0.02, 0.05, 0.03, 0.0, 0.04, 0.01])
    known = such_paths(values, "share", 0.9)
    assert known is not None
    assert at_most(values, "share", known.high).p == pytest.approx(0.95, abs=0.01)
    assert at_most(values, "share", known.low).p == pytest.approx(0.05, abs=0.01)


def test_shares_that_agree_are_doubted_by_the_number_of_paths_alone() -> None:
    """Half of six paths miss .1 each: the mean is within .05 as surely as half are within half."""
    values = np.array([0.1, 0.0, 0.1, 0.0, 0.1, 0.0])
    assert at_most(values, "share", 0.05).p == pytest.approx(beta.cdf(0.5, 3.5, 3.5), abs=1e-3)


def test_zeros_and_negative_limits_need_no_logarithm() -> None:
    """Switches that nowhere happen are within any limit; a limit below 0 is broken by any value."""
    assert at_most(np.zeros(3), "positive", 1.0).high == -1.0
    assert at_most(np.zeros(3), "positive", 0.0).high == 0.0
    assert at_most(np.array([1.0, 1.0, 1.0]), "positive", -1.0).p == 0.0
    assert at_most(np.array([1.0, 1.1, 1.2]), "positive", 0.0).p == 0.0


def test_values_of_either_sign_are_judged_by_t() -> None:
    """Mean 0 of -1, 0, 1 is within 2 by t of 2 · √3 on two degrees."""
    found = at_most(np.array([-1.0, 0.0, 1.0]), "signed", 2.0)
    assert found.p == pytest.approx(student.cdf(2.0 * 3.0**0.5, 2))


@pytest.mark.parametrize("kind", ["positive", "share"])
def test_promises_that_hold_are_seldom_failed(kind: str) -> None:
    """At a limit of the true mean, p below .01 comes in 1 % of samples or little more.

    Times are log-normal of sd .3; shares are missed on half of the paths, beta (1, 4) there.
    """
    rng = np.random.default_rng(3)
    wrong, n, studies = 0, 6, 1000
    for _ in range(studies):
        if kind == "positive":
            values, mean = np.exp(0.3 * rng.standard_normal(n)), float(np.exp(0.045))
        else:
            values, mean = rng.beta(1, 4, n) * (rng.random(n) < 0.5), 0.1
        wrong += at_most(values, kind, mean).p < 0.01  # pyright: ignore[reportArgumentType]
    assert wrong / studies < 0.02
