"""The gate's decisions: by hand, against scipy, and how often they are wrong or missing."""

import math
from collections.abc import Sequence

import numpy as np
import pytest
from scipy.stats import ttest_1samp

from lodbench.analysis.verdict.paired import (
    FAIL_ALPHA,
    Judgement,
    by_t,
    decide,
    excess,
    holm,
    needed_replicates,
    one_sided_p,
)

NOW = np.array([10.2, 11.1, 9.9, 10.8, 10.4])
THEN = np.array([10.0, 10.7, 9.8, 10.5, 10.2])


def judge(excesses: Sequence[np.ndarray]) -> tuple[Judgement, ...]:
    """Return the judgement of each of several limits, as the gate judges them together."""
    return decide([by_t(of, FAIL_ALPHA / len(excesses)) for of in excesses])


def test_excess_by_hand() -> None:
    """Relative limits are shares of before; absolute ones are of the change, or of now alone."""
    now, then = np.array([11.0, 9.0]), np.array([10.0, 10.0])
    assert excess(now, then, 0.05, relative=True) == pytest.approx([0.5, -1.5])
    assert excess(now, then, 0.3, relative=False) == pytest.approx([0.7, -1.3])
    assert excess(now, np.zeros(2), 10.0, relative=False) == pytest.approx([1.0, -1.0])


def test_of_a_metric_in_which_more_is_better_the_negatives_are_judged() -> None:
    """A fall from 10 to 9 is a tenth: beyond a limit of 5 % by half a unit."""
    assert excess(np.array([-9.0]), np.array([-10.0]), 0.05, relative=True) == pytest.approx([0.5])


def test_p_agrees_with_scipy() -> None:
    """The one-sided paired t of another library, without limit and with one."""
    oracle = ttest_1samp(NOW - THEN, 0.0, alternative="greater").pvalue
    assert one_sided_p(NOW, THEN, 0.0, relative=False) == pytest.approx(float(oracle))
    oracle = ttest_1samp(NOW - 1.02 * THEN, 0.0, alternative="greater").pvalue
    assert one_sided_p(NOW, THEN, 0.02, relative=True) == pytest.approx(float(oracle))


@pytest.mark.parametrize(("now", "expected"), [(11.0, 1.0), (11.1, 0.0), (9.0, 1.0)])
def test_replicates_all_alike_leave_no_doubt(now: float, expected: float) -> None:
    """Bytes that do not change decide: at the limit and within it passes, beyond fails."""
    values = np.full(4, now), np.full(4, 10.0)
    assert one_sided_p(*values, 1.0, relative=False) == expected
    (judgement,) = judge([excess(*values, 1.0, relative=False)])
    assert judgement.verdict == ("fail" if expected == 0 else "pass")


def test_one_replicate_decides_nothing() -> None:
    """However far beyond the limit, one replicate shows no spread."""
    (judgement,) = judge([np.array([99.0])])
    assert (judgement.verdict, judgement.high, judgement.needed) == ("undecided", math.inf, None)
    assert math.isnan(judgement.p)


def test_holm_by_hand() -> None:
    """At .05 the bars of four are .0125, .0167, .025 and .05, in the order of the p."""
    assert holm([0.04, 0.001, 0.02, 0.004], 0.05).tolist() == [True, True, True, True]
    assert holm([0.04, 0.001, 0.03, 0.004], 0.05).tolist() == [False, True, False, True]
    assert holm([0.013, 0.001, 0.001, 0.9], 0.05).tolist() == [True, True, True, False]


def test_holm_stops_at_the_first_that_stands() -> None:
    """.009 would fall alone at .01, but .006 before it stands at .005."""
    assert holm([0.009, 0.006]).tolist() == [False, False]
    assert holm([0.009]).tolist() == [True]
    assert holm([]).tolist() == []


def test_holm_counts_what_is_not_known() -> None:
    """A limit without a p is never rejected, and makes the others no easier."""
    assert holm([math.nan, 0.004]).tolist() == [False, True]
    assert holm([math.nan, 0.006]).tolist() == [False, False]


def test_the_three_verdicts_by_hand() -> None:
    """Beyond for sure, within for sure, and neither, with what would decide it."""
    noise = np.array([-1.0, 1.0, -0.5, 0.5, 0.0])
    beyond, within, unclear = judge([noise + 9, noise - 9, noise + 0.4])
    assert [of.verdict for of in (beyond, within, unclear)] == ["fail", "pass", "undecided"]
    assert beyond.excess == pytest.approx(9.0)
    assert (beyond.needed, within.needed) == (None, None)
    assert unclear.needed is not None
    assert unclear.needed > 5


def test_needed_replicates_decide() -> None:
    """With as many replicates as were asked for, four in five studies decide; with half, fewer."""
    rng = np.random.default_rng(1)
    pilot = rng.standard_normal(6)
    pilot = (pilot - pilot.mean()) / pilot.std(ddof=1) - 0.5  # mean −.5, spread 1, exactly
    needed = needed_replicates(pilot, 0.0)
    assert needed is not None

    def decided(count: int) -> float:
        judged = [judge([rng.standard_normal(count) - 0.5])[0] for _ in range(600)]
        return float(np.mean([of.verdict == "pass" for of in judged]))

    assert 0.75 < decided(needed) < 0.86
    assert decided(needed // 2) < 0.6


def test_needed_replicates_beyond_reach() -> None:
    """A mean on the limit, a hair beside it, or a single replicate: no number would decide."""
    assert needed_replicates(np.array([-1.0, 1.0]), 0.0) is None
    assert needed_replicates(np.array([-1.0, 1.0002]), 0.0) is None
    assert needed_replicates(np.array([3.0]), 0.0) is None
    assert needed_replicates(np.array([3.0, 3.0]), 0.0) == 2


def gate(rng: np.random.Generator, change: float, replicates: int = 20) -> tuple[Judgement, ...]:
    """Return the judgements of five limits of 2.5 % on a policy whose first metric changed.

    Replicates differ by a fifth, in common; each side has 1.5 % of its own, as decisions differ.
    """
    beyond: list[np.ndarray] = []
    for metric in range(5):
        path = np.exp(0.2 * rng.standard_normal(replicates))
        now, then = path * np.exp(0.015 * rng.standard_normal((2, replicates)))
        beyond.append(excess(now * (1 + change * (metric == 0)), then, 0.025, relative=True))
    return judge(beyond)


def test_an_unchanged_policy_passes() -> None:
    """Of 300 gates with five limits at most 1 % fail, and at most 10 % of limits are undecided."""
    rng = np.random.default_rng(3)
    verdicts = [[of.verdict for of in gate(rng, 0.0)] for _ in range(300)]
    assert sum("fail" in of for of in verdicts) <= 3
    assert np.mean([verdict == "undecided" for of in verdicts for verdict in of]) <= 0.1


def test_a_regression_of_five_per_cent_is_found() -> None:
    """Twice the limit: found in at least 95 % of 300 gates, and never passed."""
    rng = np.random.default_rng(4)
    verdicts = [gate(rng, 0.05)[0].verdict for _ in range(300)]
    assert verdicts.count("fail") >= 285
    assert verdicts.count("pass") == 0


def test_a_change_of_just_the_limit_rarely_fails_or_passes() -> None:
    """At the limit itself both decisions are wrong at their stated chance at most."""
    rng = np.random.default_rng(5)
    verdicts = [gate(rng, 0.025)[0].verdict for _ in range(400)]
    assert verdicts.count("fail") <= 0.01 * 400 + 3 * math.sqrt(400 * 0.01)
    assert verdicts.count("pass") <= 0.05 * 400 + 3 * math.sqrt(400 * 0.05)
