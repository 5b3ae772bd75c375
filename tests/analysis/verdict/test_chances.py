"""Probabilities of being the best: in closed form for two policies, and calibrated for many."""

import math

import numpy as np
import pytest
from scipy.stats import t

from lodbench.analysis.verdict.chances import chances, order_chances, tuning_spread
from lodbench.analysis.verdict.criterion import Criterion
from lodbench.analysis.verdict.shrinkage import shrink


def plain(values: np.ndarray, *, absolute: float = 0.0) -> Criterion:
    """Return a metric of which less is better, with an absolute margin."""
    return Criterion("error", values, relative=0.0, absolute=absolute)


def two_policies(gap: float) -> np.ndarray:
    """Return two policies on six paths that differ far more than the policies do."""
    rng = np.random.default_rng(2)
    path = 10 * rng.standard_normal(6)
    return np.array([path, path + gap + 0.1 * rng.standard_normal(6)]) + 50


def test_margin_and_regret_of_two_in_closed_form() -> None:
    """The paired difference is Student's t: its cdf at the margin, and its mean above 0."""
    values = two_policies(0.08)
    found = chances(plain(values, absolute=0.1), draws=200_000)
    difference = values[1] - values[0]
    oracle = t(
        df=5, loc=float(difference.mean()), scale=float(difference.std(ddof=1)) / math.sqrt(6)
    )
    assert found.p_within_margin[1] == pytest.approx(float(oracle.cdf(0.1)), abs=0.005)
    assert found.p_within_margin[0] == pytest.approx(float(oracle.sf(-0.1)), abs=0.005)
    grid = np.linspace(0, 3, 30_001)
    regret = float(np.trapezoid(oracle.sf(grid), grid))  # E max(d, 0)
    assert found.regret[1] == pytest.approx(regret, rel=0.02)


def test_a_lead_that_paths_share_is_seen() -> None:
    """Paths that differ a hundred times more than the policies hide nothing, as all share them."""
    found = chances(plain(two_policies(0.5)))
    assert found.p_best[0] > 0.99
    assert found.regret[1] == pytest.approx(0.5, abs=0.15)
    assert found.regret[0] < 0.01


def test_certain_and_unknown() -> None:
    """Without spread the best is certain; from one path nothing is known."""
    values = np.array([[1.0] * 4, [2.0] * 4, [1.0] * 4])
    found = chances(plain(values, absolute=0.5))
    assert found.p_best.tolist() == [0.5, 0.0, 0.5]
    assert found.p_within_margin.tolist() == [1.0, 0.0, 1.0]
    assert found.regret.tolist() == [0.0, 1.0, 0.0]
    one = chances(plain(values[:, :1]))
    assert np.isnan([one.p_best, one.p_within_margin, one.regret]).all()
    assert np.isnan(order_chances([plain(values[:, :1])]).p_best).all()


def test_tuning_makes_less_sure() -> None:
    """Five turns: a variance of 1 + 5 / 4, 1.5 times the spread; a lead is then less of a proof."""
    assert tuning_spread(5) == 1.5
    assert tuning_spread(2) == pytest.approx(math.sqrt(3.0))
    values = two_policies(0.08)
    sure = chances(plain(values), draws=20_000).p_within_margin[1]
    less = chances(plain(values), draws=20_000, spread=1.5).p_within_margin[1]
    error = float((values[1] - values[0]).std(ddof=1)) / math.sqrt(6)
    lead = float((values[1] - values[0]).mean())
    assert sure == pytest.approx(float(t(df=5).sf(lead / error)), abs=0.01)
    assert less == pytest.approx(float(t(df=5).sf(lead / (1.5 * error))), abs=0.01)


@pytest.mark.parametrize("policies", [2, 7])
def test_identical_policies_share(policies: int) -> None:
    """Copies share their chance evenly, to the bit, and adding one takes none from the others."""
    rng = np.random.default_rng(3)
    values = rng.standard_normal((policies, 8)) + 5
    alone = chances(plain(values))
    doubled = chances(plain(np.concatenate((values, values[:1]))))
    assert doubled.p_best[0] == doubled.p_best[-1] == alone.p_best[0] / 2
    assert doubled.p_best[1:-1].tolist() == alone.p_best[1:].tolist()
    assert doubled.p_best.sum() == pytest.approx(1.0)


def test_higher_is_better_mirrors() -> None:
    """Of a metric in which more is better, the negatives have the same chances."""
    values = np.random.default_rng(4).standard_normal((4, 8)) + 5
    lower = chances(Criterion("m", values, relative=0.1))
    higher = chances(Criterion("m", -values, better="higher", relative=0.1))
    assert lower.p_best.tolist() == higher.p_best.tolist()
    assert lower.p_within_margin.tolist() == higher.p_within_margin.tolist()


def test_order_decides_by_the_first_metric_that_differs() -> None:
    """Equal within the margin in error, the fewer pops win; far behind in error, nothing helps."""
    noise = 0.01 * np.random.default_rng(5).standard_normal((3, 3, 10))
    error = np.array([[1.0], [1.1], [3.0]]) + noise[0]
    pops = np.array([[90.0], [20.0], [0.0]]) + noise[1]
    work = np.array([[5.0], [6.0], [1.0]]) + noise[2]
    criteria = [
        Criterion("error", error, absolute=0.25),
        Criterion("pops", pops),
        Criterion("work", work),
    ]
    assert order_chances(criteria).p_best.tolist() == [0.0, 1.0, 0.0]
    assert order_chances(criteria[:1]).p_best[0] > 0.99
    assert order_chances(criteria[::-1]).p_best.tolist() == [0.0, 0.0, 1.0]


def studies(
    policies: int, spread: float, count: int
) -> list[tuple[float, bool, np.ndarray, np.ndarray]]:
    """Return of each study the largest P(best), whether it is right, and P(within) beside truth."""
    rng = np.random.default_rng(policies)
    found: list[tuple[float, bool, np.ndarray, np.ndarray]] = []
    for seed in range(count):
        truth = 2 + spread * rng.standard_normal(policies)
        path = 0.5 * rng.standard_normal(10)
        values = truth[:, None] + path + 0.3 * rng.standard_normal((policies, 10))
        of = chances(plain(values, absolute=0.1), draws=400, seed=seed)
        first = int(of.p_best.argmax())
        within = truth <= truth.min() + 0.1
        found.append((float(of.p_best[first]), first == truth.argmin(), of.p_within_margin, within))
    return found


@pytest.mark.parametrize("policies", [2, 6, 12])
def test_chances_are_not_overconfident(policies: int) -> None:
    """In each bin the best is right as often as said, less five points, near equals or far apart.

    A standard error of a paired difference is .13; policies differ by .05 to .3.
    """
    found = [of for spread in (0.05, 0.1, 0.3) for of in studies(policies, spread, 160)]
    said = np.array([of[0] for of in found])
    right = np.array([of[1] for of in found])
    within_said = np.concatenate([of[2] for of in found])
    within = np.concatenate([of[3] for of in found])
    for claims, truths in ((said, right), (within_said, within)):
        for low, high in ((0.5, 0.7), (0.7, 0.9), (0.9, 1.01)):
            inside = (claims >= low) & (claims < high)
            count = int(inside.sum())
            assert count >= 20
            noise = math.sqrt(0.25 / count) if claims is said else 0.0
            assert claims[inside].mean() - truths[inside].mean() < 0.05 + noise
    # Nor does it say nothing: where policies differ, it says so.
    assert (said > 0.9).mean() > 0.05


def test_of_many_equals_none_is_the_best() -> None:
    """Twelve equal policies: the one in front is rarely called probably the best."""
    rng = np.random.default_rng(9)
    leads = [
        chances(plain(rng.standard_normal((12, 10)) + 9), draws=400).p_best.max()
        for _ in range(150)
    ]
    assert np.mean(np.array(leads) > 0.7) < 0.05
    assert np.mean(leads) < 0.4


def test_shrinking_leaves_policies_far_apart_alone() -> None:
    """Draws of means that are many errors apart are not changed, and keep their order and mean."""
    rng = np.random.default_rng(1)
    values = np.array([[1.0], [2.0], [9.0]]) + 0.01 * rng.standard_normal((3, 10))
    sampled = values.mean(axis=1) + 0.003 * rng.standard_normal((500, 3))
    assert (shrink(sampled, values, rng) == sampled).all()


def test_shrinking_draws_near_equals_together() -> None:
    """Two means half an error apart keep a fraction of their difference, and their middle."""
    rng = np.random.default_rng(1)
    noise = rng.standard_normal((2, 10))
    noise -= noise.mean(axis=1, keepdims=True)
    values = np.array([[1.0], [1.2]]) + noise
    sampled = values.mean(axis=1) + 0.3 * rng.standard_normal((4000, 2))
    shrunk = shrink(sampled, values, rng)
    assert shrunk.mean(axis=1) == pytest.approx(sampled.mean(axis=1))
    gap = float((shrunk[:, 1] - shrunk[:, 0]).mean())
    assert 0 < gap < 0.12
