"""The chance that another path is kept: worked by hand, against scipy, and against fresh paths."""

import math

import numpy as np
import pytest
from scipy.stats import binomtest, norm, t

from lodbench.analysis.verdict.keeping import (
    exact_bound,
    keeping,
    p_keeps,
    p_keeps_with_machine,
    predictive_probability,
)


def test_two_paths_by_hand() -> None:
    """Ratios e⁻¹ and e⁻³: m −2, s √2, T = 2 / √3, and with one degree ½ + atan(T) / π."""
    probability = p_keeps(np.exp([-1.0, -3.0]) * 16.0, 16.0)
    assert probability == pytest.approx(0.5 + math.atan(2 / math.sqrt(3)) / math.pi, abs=1e-12)


def test_agrees_with_scipy() -> None:
    """Seven paths, by the t distribution of another library."""
    p99_ms = np.array([7.0, 7.5, 6.2, 8.4, 7.9, 6.8, 7.1])
    ln_ratio = np.log(p99_ms / 8.0)
    scale = float(ln_ratio.std(ddof=1)) * math.sqrt(1 + 1 / 7)
    oracle = t(df=6, loc=float(ln_ratio.mean()), scale=scale)
    assert p_keeps(p99_ms, 8.0) == pytest.approx(float(oracle.cdf(0.0)), abs=1e-12)


@pytest.mark.parametrize(("p99_ms", "expected"), [(7.9, 1.0), (8.0, 1.0), (8.1, 0.0)])
def test_paths_all_alike(p99_ms: float, expected: float) -> None:
    """Without spread the budget is surely kept, the budget itself included, or surely missed."""
    assert p_keeps(np.full(6, p99_ms), 8.0) == expected


def test_one_path_tells_nothing() -> None:
    """One path shows no spread, so there is no probability; that it was kept bounds little."""
    found = keeping(np.array([4.0]), 8.0)
    assert math.isnan(found.probability)
    assert (found.kept, found.paths, found.high) == (1, 1, 1.0)
    assert found.low == pytest.approx(0.05)  # p¹ = .05


def test_more_budget_is_surer() -> None:
    """The probability never falls with the budget, and goes from 0 to 1."""
    p99_ms = np.array([7.0, 9.0, 8.0, 6.5])
    found = [p_keeps(p99_ms, budget_ms) for budget_ms in np.geomspace(0.1, 1000, 60)]
    assert (np.diff(found) >= 0).all()
    assert found[0] < 0.001
    assert found[-1] > 0.999


@pytest.mark.parametrize(("kept", "n"), [(0, 10), (3, 10), (10, 10), (1, 2), (17, 20)])
def test_exact_bound_agrees_with_scipy(kept: int, n: int) -> None:
    """Clopper and Pearson's bounds, by another library."""
    bound = binomtest(kept, n).proportion_ci(0.9, method="exact")
    assert exact_bound(kept, n) == pytest.approx((bound.low, bound.high), abs=1e-9)


@pytest.mark.parametrize("n", [2, 4, 10])
@pytest.mark.parametrize("said", [0.3, 0.7, 0.9])
def test_budget_set_for_a_probability_is_kept_as_often(n: int, said: float) -> None:
    """A budget at which the answer is q is kept by a fresh path in q of 40,000 studies."""
    rng = np.random.default_rng(5)
    seen, fresh = rng.standard_normal((40_000, n)), rng.standard_normal(40_000)
    reach = t.ppf(said, n - 1) * math.sqrt(1 + 1 / n)
    budget = seen.mean(axis=1) + reach * seen.std(axis=1, ddof=1)
    assert predictive_probability(seen - budget[:, None]) == pytest.approx(said, abs=1e-9)
    kept = float((fresh <= budget).mean())
    assert abs(kept - said) < 3.5 * math.sqrt(said * (1 - said) / 40_000)


@pytest.mark.parametrize("n", [4, 8, 10])
def test_not_overconfident_in_any_bin(n: int) -> None:
    """Budgets that no data chose are kept as often as said, within five points, in each bin."""
    rng = np.random.default_rng(5)
    offset = rng.uniform(-1.5, 1.5, (40_000, 1))
    seen = offset + 0.4 * rng.standard_normal((40_000, n))
    fresh = offset[:, 0] + 0.4 * rng.standard_normal(40_000)
    said = predictive_probability(seen)
    for low, high in ((0.5, 0.7), (0.7, 0.9), (0.9, 1.01)):
        inside = (said >= low) & (said < high)
        assert inside.sum() > 2000
        assert said[inside].mean() - (fresh[inside] <= 0).mean() < 0.05


def test_two_machines_by_hand() -> None:
    """Draws half and twice as dear shift ln by ∓ ln 2: the mean of the chances at both shifts."""
    p99_ms = np.array([7.0, 7.5, 6.2])
    shifted = [p_keeps(p99_ms * factor, 8.0) for factor in (0.5, 2.0)]
    drawn_ms = np.array([[3.0, 5.0], [12.0, 20.0]])
    found = p_keeps_with_machine(p99_ms, drawn_ms, 8.0)
    assert found == pytest.approx(np.mean(shifted), abs=1e-12)


def test_machines_all_alike_change_nothing() -> None:
    """Who takes the same time on every draw keeps the budget as surely as on the one fitted."""
    p99_ms = np.array([7.0, 7.5, 6.2, 8.1])
    found = p_keeps_with_machine(p99_ms, np.full((8, 2), 7.3), 8.0)
    assert found == pytest.approx(p_keeps(p99_ms, 8.0), abs=1e-12)


@pytest.mark.parametrize(("spread", "machine"), [(0.1, 0.05), (0.1, 0.25), (0.02, 0.25)])
def test_what_is_said_of_other_machines_is_true_of_them(spread: float, machine: float) -> None:
    """Over 2,000 worlds of five paths and eight draws, others keep as often as was said.

    A draw's factor, and that of the machine on which a new path is replayed, are of one log-normal
    distribution; draws are one in each eighth of it, as those of a profile are.
    """
    rng = np.random.default_rng(8)
    said, kept = np.empty(2000), np.empty(2000)
    for at in range(2000):
        level = rng.normal(-0.15, 0.2)
        paths = rng.normal(level, spread, 5)
        parts = norm.ppf((np.arange(8) + rng.uniform(size=8)) / 8)
        drawn = np.exp(level + machine * parts[:, None] + rng.normal(0.0, spread, 2))
        said[at] = p_keeps_with_machine(np.exp(paths), drawn, 1.0)
        kept[at] = rng.normal(level, spread) + machine * rng.normal() <= 0.0
    sure = said > 0.8
    assert said.mean() == pytest.approx(kept.mean(), abs=0.03)
    assert said[sure].mean() == pytest.approx(kept[sure].mean(), abs=0.04)
    assert said[~sure].mean() == pytest.approx(kept[~sure].mean(), abs=0.04)
