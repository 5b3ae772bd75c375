"""Intervals: by hand, against scipy, and by how often they cover what they say they cover."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import beta, t

from lodbench.analysis.verdict.intervals import (
    Interval,
    such_paths,
    this_path,
    welch_degrees,
    with_machine,
)
from lodbench.analysis.verdict.metric_kinds import Kind

Draw = Callable[[np.random.Generator, int], np.ndarray]


def over_paths(values: np.ndarray, kind: Kind) -> Interval:
    """Return the interval over such paths of a kind that has one."""
    found = such_paths(values, kind)
    assert found is not None
    return found


def coverage(studies: list[Interval], truth: float) -> float:
    """Return the share of intervals that hold the truth."""
    return float(np.mean([of.low <= truth <= of.high for of in studies]))


def noise_of(share: float, studies: int) -> float:
    """Return three binomial standard errors."""
    return 3 * math.sqrt(share * (1 - share) / studies)


def test_signed_is_students() -> None:
    """A difference of either sign has the interval that another library gives."""
    values = np.array([-1.0, 2.0, 0.5, 1.5, -0.2, 0.9])
    found = over_paths(values, "signed")
    error = float(values.std(ddof=1)) / math.sqrt(6)
    oracle = t(df=5, loc=float(values.mean()), scale=error)
    assert (found.low, found.high) == pytest.approx(oracle.interval(0.9))
    assert found.enough


def test_positive_by_hand() -> None:
    """Values 1 and 3: mean 2, squared variation ½, with its half square ⅝ over 2 paths."""
    found = over_paths(np.array([1.0, 3.0]), "positive")
    reach = math.tan(math.pi * 0.45) * math.sqrt(0.625 / 2)  # t of one degree at .95
    assert (found.low, found.high) == pytest.approx((2 * math.exp(-reach), 2 * math.exp(reach)))
    assert (found.enough, found.needed) == (False, 6)  # four, and four times ½


def test_share_that_none_missed_has_the_exact_bound() -> None:
    """No miss on ten paths is not zero: up to 1 − .05^(1/10) of paths may miss, wholly."""
    found = over_paths(np.zeros(10), "share")
    assert (found.low, found.enough) == (0.0, True)
    assert found.high == pytest.approx(1 - 0.05**0.1)


def test_share_of_equal_misses_is_the_beta_interval() -> None:
    """Four of ten paths that miss a fifth of the time each: a fifth of Jeffreys' interval."""
    found = over_paths(np.array([0.2] * 4 + [0.0] * 6), "share")
    oracle = 0.2 * beta(4.5, 6.5).ppf([0.05, 0.95])
    assert (found.low, found.high) == pytest.approx(oracle.tolist(), rel=0.03)
    assert found.enough


def test_one_miss_in_ten_is_known_badly() -> None:
    """How long misses are is not known from one: its interval reaches far to either side."""
    found = over_paths(np.array([0.2] + [0.0] * 9), "share")
    assert found.low < 0.2 * found_share(1, 10, 0.05) < 0.2 * found_share(1, 10, 0.95) < found.high
    assert over_paths(np.array([0.2] + [0.0] * 9), "positive").enough is False


def found_share(k: int, n: int, at: float) -> float:
    """Return a quantile of Jeffreys' posterior of a share of which k of n were seen."""
    return float(beta(k + 0.5, n - k + 0.5).ppf(at))


def test_a_share_never_exceeds_one() -> None:
    """Nor does a share whose every path is near the whole."""
    found = over_paths(np.array([0.9, 1.0, 0.3, 1.0]), "share")
    assert 0 < found.low < found.high <= 1


@pytest.mark.parametrize(("truth", "sd"), [(0.48, 0.05), (0.5, 0.02), (0.52, 0.05), (0.3, 0.1)])
def test_shares_about_a_half_are_covered_as_stated(truth: float, sd: float) -> None:
    """Of ten paths each: a share has no side to lean to there, and no border at a half."""
    rng = np.random.default_rng(11)
    both = truth * (1.0 - truth) / sd**2 - 1.0
    studies = rng.beta(truth * both, (1.0 - truth) * both, (800, 10))
    found = [over_paths(values, "share") for values in studies]
    covered = np.mean([interval.low <= truth <= interval.high for interval in found])
    assert covered == pytest.approx(0.9, abs=noise_of(0.9, 800))
    below, above = (
        over_paths(np.array([0.5, 0.5, 0.5, 0.51, last]), "share") for last in (0.49, 0.4901)
    )
    assert above.low == pytest.approx(below.low, abs=1e-3)
    assert above.high == pytest.approx(below.high, abs=1e-3)


def test_a_share_that_is_the_whole_on_all_paths_may_be_less_on_others() -> None:
    """Ten paths that miss all of the time: at worst .05^(1/10) of such paths do, and none else."""
    found = over_paths(np.ones(10), "share")
    assert (found.low, found.high, found.enough) == (pytest.approx(0.05**0.1), 1.0, True)
    mirrored = over_paths(np.array([0.9, 1.0, 0.8, 1.0]), "share")
    missing = over_paths(np.array([0.1, 0.0, 0.2, 0.0]), "share")
    assert (mirrored.low, mirrored.high) == pytest.approx((1 - missing.high, 1 - missing.low))


@pytest.mark.parametrize("kind", ["positive", "signed"])
@pytest.mark.parametrize("refresh_ms", [16.666666, 16.666667])
def test_paths_that_are_all_alike_tell_nothing_of_others(kind: Kind, refresh_ms: float) -> None:
    """A tenth of such paths take two refreshes, of which ten paths hold none in 35 %: not enough.

    Refreshes end at whole nanoseconds, which are no spread.
    """
    values = np.array([16.666667] * 9 + [refresh_ms])
    assert not over_paths(values, kind).enough
    assert over_paths(np.array([16.666667] * 7 + [33.333333] * 3), kind).enough


def test_a_rate_that_the_display_does_not_bound_may_be_higher_on_other_paths() -> None:
    """Rates that all differ show no bound: the interval reaches up as far as that of times."""
    values = np.array([18.0, 20.0, 21.0, 22.0, 19.0])
    assert over_paths(values, "capped") == over_paths(values, "positive")
    assert over_paths(values, "capped").high > 20.0


def test_nothing_seen_of_an_unbounded_metric_is_not_enough() -> None:
    """Where no path has any, no number bounds how much another may have."""
    assert over_paths(np.zeros(10), "positive") == Interval(0.0, 0.0, enough=False, needed=None)


def test_extremes_have_none_and_one_path_has_no_number() -> None:
    """A maximum is shown as observed; one path shows no spread over such paths."""
    assert such_paths(np.array([1.0, 2.0, 3.0]), "extreme") is None
    assert with_machine(np.ones(3), np.ones((4, 2)), "extreme") is None
    found = over_paths(np.array([2.0]), "positive")
    assert (math.isnan(found.low), found.enough, found.needed) == (True, False, 4)


def test_units_scale_the_interval() -> None:
    """Milliseconds or seconds: the same interval."""
    values = np.array([3.0, 4.0, 2.5, 8.0, 3.3])
    for kind in ("positive", "signed"):
        ms, s = over_paths(values, kind), over_paths(values / 1e3, kind)
        assert (s.low * 1e3, s.high * 1e3) == pytest.approx((ms.low, ms.high))
        assert ms.needed == s.needed


DRAWS: dict[str, tuple[Draw, float, Kind]] = {
    "normal, varying by a tenth": (
        lambda rng, n: 1 + 0.1 * rng.standard_normal(n),
        1.0,
        "positive",
    ),
    "log-normal, .5": (
        lambda rng, n: np.exp(0.5 * rng.standard_normal(n)),
        math.exp(0.125),
        "positive",
    ),
    "exponential": (lambda rng, n: rng.exponential(size=n), 1.0, "positive"),
    "gamma, 2": (lambda rng, n: rng.gamma(2, size=n), 2.0, "positive"),
    "normal difference": (lambda rng, n: rng.standard_normal(n), 0.0, "signed"),
    "share, a third of paths": (
        lambda rng, n: np.where(rng.random(n) < 1 / 3, rng.beta(2, 8, n), 0.0),
        0.2 / 3,
        "share",
    ),
    "share, nearly all paths": (
        lambda rng, n: np.where(rng.random(n) < 0.9, rng.beta(2, 8, n), 0.0),
        0.18,
        "share",
    ),
    "pops, two thirds of paths": (
        lambda rng, n: np.where(rng.random(n) < 2 / 3, rng.gamma(3, size=n), 0.0),
        2.0,
        "positive",
    ),
}


@pytest.mark.parametrize("name", DRAWS)
@pytest.mark.parametrize("n", [10, 20])
def test_such_paths_cover(name: str, n: int) -> None:
    """Of 90 % intervals that call themselves enough, 82 to 97 % hold the mean of all such paths."""
    draw, truth, kind = DRAWS[name]
    rng = np.random.default_rng(n)
    studies = [over_paths(draw(rng, n), kind) for _ in range(700)]
    enough = [of for of in studies if of.enough]
    assert len(enough) > (0.75 if n == 20 else 0.5) * len(studies)
    noise = noise_of(0.9, len(enough))
    assert 0.85 - noise <= coverage(enough, truth) <= 0.95 + noise


def test_such_paths_cover_pooled() -> None:
    """Over kinds of metric together, of all intervals whether enough or not, 87 to 93 %."""
    rng = np.random.default_rng(2)
    shares = [
        coverage([over_paths(draw(rng, 10), kind) for _ in range(400)], truth)
        for draw, truth, kind in DRAWS.values()
    ]
    assert 0.87 <= np.mean(shares) <= 0.93


def test_skew_that_ten_paths_cannot_cover_is_said() -> None:
    """Of very skewed values most studies say that ten paths are too few, and ask for more."""
    rng = np.random.default_rng(4)
    studies = [over_paths(np.exp(2 * rng.standard_normal(10)), "positive") for _ in range(400)]
    few = [of for of in studies if not of.enough]
    assert len(few) > 300
    assert all(of.needed is not None and of.needed > 10 for of in few)
    steady = [over_paths(1 + 0.2 * rng.random(10), "positive") for _ in range(200)]
    assert all(of.enough for of in steady)


def test_this_path_by_hand() -> None:
    """One path, seeds 1 and 3: mean 2, error 1, one degree of freedom; two more seeds would do."""
    found = this_path(np.array([[1.0, 3.0]]))
    reach = math.tan(math.pi * 0.45)
    assert (found.low, found.high) == pytest.approx((2 - reach, 2 + reach))
    assert (found.enough, found.needed) == (False, 4)


def test_this_path_without_noise_or_without_seeds() -> None:
    """Equal seeds leave no doubt; a single seed leaves every doubt."""
    values = np.array([[1.0, 1.0], [5.0, 5.0], [9.0, 9.0]])
    assert this_path(values) == Interval(5.0, 5.0, enough=True, needed=None)
    found = this_path(values[:, :1])
    assert (math.isnan(found.low), found.enough, found.needed) == (True, False, 2)


@pytest.mark.parametrize("seeds", [2, 5])
@pytest.mark.parametrize("spread", [0.0, 1.0])
def test_this_path_covers_other_noise(seeds: int, spread: float) -> None:
    """However paths differ, in level or in noise, the mean over them under all noise is covered."""
    rng = np.random.default_rng(seeds)
    level = rng.uniform(1, 50, 10)
    noise = np.exp(spread * rng.standard_normal(10))[:, None]
    found = [
        this_path(level[:, None] + noise * rng.standard_normal((10, seeds))) for _ in range(3000)
    ]
    share = coverage(found, float(level.mean()))
    assert 0.88 - noise_of(0.9, 3000) <= share <= 0.92 + noise_of(0.9, 3000)


def test_other_noise_is_much_less_than_other_paths() -> None:
    """On paths that differ by far more than noise moves them, this path's interval is narrow."""
    rng = np.random.default_rng(8)
    values = np.exp(0.3 * rng.standard_normal((10, 1))) * (1 + 0.01 * rng.standard_normal((10, 2)))
    this, such = this_path(values), over_paths(values.mean(axis=1), "positive")
    assert (this.high - this.low) < 0.1 * (such.high - such.low)


@pytest.mark.parametrize("kind", ["positive", "signed"])
def test_with_machine_covers_another_machine(kind: Kind) -> None:
    """The mean over such paths on one more machine of the posterior is covered in 87 to 93 %.

    The machine as fitted has the posterior's middle; it makes all paths slower or faster alike.
    """
    rng = np.random.default_rng(21)
    sd_machine, sd_path, hits = 0.15, 0.2, 0
    for _ in range(1500):
        paths = sd_path * rng.standard_normal(10)
        draws = sd_machine * rng.standard_normal(12)
        other = float(np.exp(sd_machine * rng.standard_normal()))
        of_draw = np.exp(draws[:, None] + paths[:2])
        found = with_machine(np.exp(paths), of_draw, kind)
        assert found is not None
        hits += found.low <= other * math.exp(sd_path**2 / 2) <= found.high
    assert 0.87 - noise_of(0.9, 1500) <= hits / 1500 <= 0.93 + noise_of(0.9, 1500)


def test_more_paths_do_not_make_a_machine_known() -> None:
    """With a thousand paths the interval is still as wide as the machine's part of it."""
    rng = np.random.default_rng(1)
    values = 1 + 0.01 * rng.standard_normal(1000)
    of_draw = np.array([[0.8, 0.8], [1.0, 1.0], [1.25, 1.25], [0.9, 0.9], [1.1, 1.1]])
    found = with_machine(values, of_draw, "positive")
    assert found is not None
    scale = float(np.log(of_draw[:, 0]).std(ddof=1)) * math.sqrt(1 + 1 / 5)
    reach = t(df=4, scale=scale).ppf(0.95)
    assert found.high == pytest.approx(math.exp(reach), rel=0.01)
    few = with_machine(values, of_draw[:3], "positive")
    assert few is not None
    assert (few.enough, few.needed) == (False, 4)


def test_machine_never_narrows() -> None:
    """Draws only add: the interval with the machine holds the one over such paths."""
    values = np.array([0.0, 0.1, 0.0, 0.2, 0.3, 0.05, 0.0, 0.0])
    paths = over_paths(values, "share")
    found = with_machine(
        values, np.array([[0.0, 0.1], [0.2, 0.3], [0.0, 0.0], [0.5, 0.9]]), "share"
    )
    assert found is not None
    assert 0 <= found.low <= paths.low < paths.high <= found.high <= 1


def test_degrees_of_freedom_are_no_more_than_there_are() -> None:
    """Ten equal variances of one degree each are known with ten, one alone with its own."""
    assert welch_degrees(np.ones(10), 1.0) == 10.0
    assert welch_degrees(np.array([1.0] + [0.0] * 9), 1.0) == 1.0
    assert 1.0 < welch_degrees(np.array([9.0, 1.0, 1.0]), 1.0) < 3.0


def test_a_rate_that_most_paths_hold_may_be_lower_on_others() -> None:
    """60 fps on nine of ten paths says little of the tenth: intervals cover the mean of such paths.

    Rates are 60 with probability .8, else uniform in 20 to 60: their mean is 56.
    """
    rng = np.random.default_rng(4)
    hits = studies = 0
    for _ in range(1000):
        values = np.where(rng.random(10) < 0.8, 60.0, rng.uniform(20.0, 60.0, 10))
        found = over_paths(values, "capped")
        assert found.low <= values.mean() <= found.high <= 60.0
        hits += found.low <= 56.0 <= found.high
        studies += 1
    assert hits / studies >= 0.87


def test_a_rate_that_all_paths_hold_is_bounded_exactly() -> None:
    """Ten paths at 60: with 95 % at most 26 % of such paths are below, at worst at 0."""
    found = over_paths(np.full(10, 60.0), "capped")
    assert found.high == 60.0
    assert found.low == pytest.approx(60.0 * (1.0 - (1.0 - 0.05 ** (1.0 / 10.0))), rel=1e-6)
