"""Verdicts worked by hand from values by path and seed."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from scipy import stats

from lodbench.analysis.gate.baseline import make_baseline
from lodbench.analysis.gate.check import require_load
from lodbench.analysis.gate.check_result import CheckReport, judge_all
from lodbench.analysis.gate.judgement import Verdict
from lodbench.analysis.gate.limits_file import parse_limits
from lodbench.analysis.gate.measurements import Conditions, MeasuredPolicy
from lodbench.analysis.gate.plain_text import describe
from lodbench.base.errors import InputError

Make = Callable[..., MeasuredPolicy]
Judge = Callable[..., Verdict]
student: Any = stats.t
THIS, SUCH = 'population = "this-path"', 'population = "such-paths"'


@pytest.fixture
def judge(conditions: Conditions) -> Judge:
    """Return a function from one limit, what is and what was to the verdict on it."""

    def of(
        limit: str,
        now: MeasuredPolicy,
        before: MeasuredPolicy | None = None,
        metric: str = "work_ms_p99",
        *,
        allow_new: bool = False,
    ) -> Verdict:
        limits = parse_limits(f"[limits]\n{metric} = {{ {limit} }}")
        baseline = None if before is None else make_baseline(conditions, [before], limits)
        report = judge_all(limits, [now], conditions, baseline, allow_new=allow_new)
        (verdict,) = report.verdicts
        return verdict

    return of


@pytest.mark.parametrize(
    ("limit", "outcome"),
    [
        ("max = 12.0", "passes"),
        ("max = 11.52", "passes"),
        ("max = 11.49", "undecided"),
        ('max = "budget"', "undecided"),
        ("max = 5.0", "fails"),
        ("min = 8.48", "passes"),
        ("min = 8.51", "undecided"),
        ("min = 15.0", "fails"),
        ('max = "0.6 frames"', "passes"),
    ],
)
def test_seeds_of_fixed_paths_are_judged_by_t(
    judge: Judge, make_measured: Make, limit: str, outcome: str
) -> None:
    """Five seeds of mean 10 and standard error .7071: the 95 % end is 10 ± 2.132 · .7071.

    That is 11.51 above and 8.49 below; t is 7.07 at a limit of 5 or 15, a p of .001.
    """
    verdict = judge(f"{limit}, {THIS}", make_measured([[8.0, 9.0, 10.0, 11.0, 12.0]]))
    assert verdict.outcome == outcome


def test_how_paths_differ_is_no_doubt_about_these_paths(judge: Judge, make_measured: Make) -> None:
    """Paths of 5 and 25 ms whose seeds agree keep 16 ms on these paths, and not on such paths."""
    now = make_measured([[4.9, 5.0, 5.1], [24.9, 25.0, 25.1]])
    assert judge(f"max = 16.0, {THIS}", now).outcome == "passes"
    assert judge(f"max = 16.0, {SUCH}", now).outcome == "undecided"
    assert judge(f"max = 14.0, {THIS}", now).outcome == "fails"
    assert judge(f"max = 14.0, {SUCH}", now).outcome == "undecided"


def test_a_promise_is_judged_over_paths_however_many_seeds(
    judge: Judge, make_measured: Make
) -> None:
    """Three paths of 8, 10 and 12 ms say no more with ten seeds each than with two."""
    for seeds in (2, 10):
        now = make_measured([[level] * seeds for level in (8.0, 10.0, 12.0)])
        verdict = judge(f"max = 13.5, {SUCH}", now)
        assert verdict.outcome == "undecided"
        # On the logarithm, as of any time: relative error .2 / √3 and its skewness' share.
        error = ((0.04 + 0.04**2 / 2) / 3) ** 0.5
        high = 10.0 * 2.718281828 ** (student.ppf(0.95, 2) * error)
        assert verdict.bound == pytest.approx(high)
        assert verdict.needed is not None
        assert verdict.needed > 3


BASE = [[10.0, 10.4], [20.0, 20.6], [40.0, 41.0]]


@pytest.mark.parametrize(
    ("factor", "limit", "outcome"),
    [
        (1.00, 'max_increase = "0%"', "passes"),
        (1.05, 'max_increase = "2.5%"', "fails"),
        (1.05, 'max_increase = "5.1%"', "passes"),
        (1.05, 'max_increase = "2.5%", floor = 0.4', "fails"),
        (1.05, 'max_increase = "2.5%", floor = 2.2', "passes"),
        (1.05, 'max_increase = "0.05 frames"', "fails"),
        (1.05, 'max_increase = "0.1 frames"', "passes"),
        (0.90, 'max_increase = "0%"', "passes"),
        (0.90, 'max_decrease = "5%"', "fails"),
        (0.90, 'max_decrease = "20%"', "passes"),
    ],
)
def test_changes_are_judged_pair_by_pair(
    judge: Judge, make_measured: Make, factor: float, limit: str, outcome: str
) -> None:
    """5 % more in every pair is 5 % more, although the values of the pairs lie far apart."""
    now = make_measured([[factor * value for value in row] for row in BASE])
    verdict = judge(f"{limit}, {THIS}", now, make_measured(BASE))
    assert verdict.outcome == outcome
    assert verdict.change is not None
    assert verdict.change.value == pytest.approx(100.0 * (factor - 1.0))


def test_pairs_are_of_one_path_and_seed(judge: Judge, make_measured: Make) -> None:
    """The same values under exchanged seeds are no pairs: they differ from seed to seed."""
    swapped = make_measured([row[::-1] for row in BASE])
    assert judge(f'max_increase = "1%", {THIS}', swapped, make_measured(BASE)).outcome == (
        "undecided"
    )


def test_a_regression_of_some_paths_is_none_of_such_paths(
    judge: Judge, make_measured: Make
) -> None:
    """5 and 5 % up on these two paths of four, 5 % down on two: nothing about other paths."""
    before = make_measured([[10.0, 10.1]] * 4)
    now = make_measured([[10.6, 10.7], [10.6, 10.7], [9.6, 9.7], [9.6, 9.7]])
    verdict = judge(f'max_increase = "0%", {SUCH}', now, before)
    assert verdict.outcome == "undecided"
    assert verdict.needed_text.endswith("paths")
    assert judge(f'max_increase = "0%", {THIS}', now, before).outcome == "fails"


def test_a_change_from_zero_is_in_the_metrics_unit(judge: Judge, make_measured: Make) -> None:
    """Where the baseline is 0 any share of it is 0, and the change is told as it is."""
    metric = "toggles_per_s"
    before, now = (make_measured([[value] * 3] * 2, metric) for value in (0.0, 0.2))
    verdict = judge(f'max_increase = "5%", {THIS}', now, before, metric)
    assert verdict.outcome == "fails"
    assert "+0.2 [< +0.2] 1/s on a baseline of 0" in describe(verdict)
    allowed = judge(f'max_increase = "5%", floor = 0.3, {THIS}', now, before, metric)
    assert allowed.outcome == "passes"


def test_an_extreme_is_judged_as_observed(judge: Judge, make_measured: Make) -> None:
    """One replay of 3.435 ms breaks a limit of 3.35, although the mean of all is 3.31."""
    now = make_measured([[3.2, 3.3, 3.305, 3.435]], "work_ms_max")
    for population in (THIS, SUCH):
        verdict = judge(f"max = 3.35, {population}", now, metric="work_ms_max")
        assert (verdict.outcome, verdict.value, verdict.population) == ("fails", 3.435, "observed")
        assert judge(f"max = 3.44, {population}", now, metric="work_ms_max").outcome == "passes"
    assert verdict.worst is not None
    assert (verdict.worst.seed, verdict.worst.moment.path) == (3, "walk-0")


def test_what_the_baseline_lacks_fails_unless_allowed(
    judge: Judge, make_measured: Make, conditions: Conditions
) -> None:
    """No baseline, another policy, a path of another content: each fails and says which."""
    limit, now = f'max_increase = "5%", {THIS}', make_measured(BASE)
    others = {
        "there is no baseline": None,
        "the baseline has no pid in yard": make_measured(BASE, policy="full"),
        "the baseline has no path walk-2": make_measured(BASE[:2]),
        "the baseline's path walk-0 is another": replace(now, hashes=("a", "b", "c")),
    }
    for reason, before in others.items():
        verdict = judge(limit, now, before)
        assert verdict.outcome == "fails"
        assert reason in describe(verdict)
        allowed = judge(limit, now, before, allow_new=True)
        assert allowed.outcome == "passes"
        assert "new, which --allow-new allows" in describe(allowed)
    limits = parse_limits(f"[limits]\nwork_ms_p99 = {{ {limit} }}")
    other = parse_limits(f"[limits]\nlag_ms_mean = {{ {limit} }}")
    baseline = make_baseline(conditions, [now], other)
    (verdict,) = judge_all(limits, [now], conditions, baseline).verdicts
    assert verdict.outcome == "fails"
    assert "the baseline has no work_ms_p99" in describe(verdict)


def test_paths_without_a_value_are_left_out(judge: Judge, make_measured: Make) -> None:
    """A step that comes on two paths of three is judged on these two; on none it is undecided."""
    metric = "settle_ms"
    some = make_measured([[90.0, 91.0], [None, None], [110.0, 111.0]], metric)
    # Two seeds on each of two paths are two degrees of freedom: 100.5 + 2.92 * 0.354 = 101.53.
    verdict = judge(f"max = 101.6, {THIS}", some, metric=metric)
    assert (verdict.outcome, verdict.value) == ("passes", 100.5)
    none = make_measured([[None, None]] * 2, metric)
    verdict = judge(f"max = 120.0, {THIS}", none, metric=metric)
    assert verdict.outcome == "undecided"
    assert "nothing of the kind happened" in describe(verdict)


def test_a_path_with_a_value_on_one_side_is_no_pair(judge: Judge, make_measured: Make) -> None:
    """A step that settles in 50 ms now and never came before, or the reverse, changes nothing."""
    metric = "settle_ms"
    one = make_measured([[10.0, 10.1], [None, None]], metric)
    both = make_measured([[10.0, 10.1], [50.0, 51.0]], metric)
    for now, before in ((both, one), (one, both)):
        verdict = judge(f'max_increase = "5%", {THIS}', now, before, metric)
        assert verdict.outcome == "passes"
        assert verdict.change is not None
        assert verdict.change.baseline == pytest.approx(10.05)


def test_shares_of_a_negative_metric_are_of_its_size(judge: Judge, make_measured: Make) -> None:
    """From -10 to -9.6 is an increase by 4 %, which 5 % allow and 2 % do not."""
    metric = "prediction_error_pct_mean"
    before, now = (make_measured([[value] * 2], metric) for value in (-10.0, -9.6))
    assert judge(f'max_increase = "5%", {THIS}', now, before, metric).outcome == "passes"
    verdict = judge(f'max_increase = "2%", {THIS}', now, before, metric)
    assert verdict.outcome == "fails"
    assert "+4 [< +4] %" in describe(verdict)


def test_all_limits_are_judged_together(make_measured: Make, conditions: Conditions) -> None:
    """A p of .007 fails alone at .01, and not among four, three of which are kept (Holm)."""
    seeds = [[10.0, 11.0, 12.0, 13.0, 14.0]]
    one = parse_limits(f"[limits]\nwork_ms_p99 = {{ max = 9.0, {THIS} }}")
    now = make_measured(seeds)
    assert judge_all(one, [now], conditions, None).verdicts[0].p == pytest.approx(
        student.sf(3.0 / 0.5**0.5, 4)
    )
    assert judge_all(one, [now], conditions, None).verdicts[0].outcome == "fails"
    others = [make_measured([[5.0, 5.1]], policy=f"other-{at}") for at in range(3)]
    report = judge_all(one, [now, *others], conditions, None)
    assert [verdict.outcome for verdict in report.verdicts] == ["undecided", *["passes"] * 3]
    assert report.verdicts[0].needed_text.endswith("seeds")


def test_a_rule_for_one_path_takes_it_out_of_the_others(
    make_measured: Make, conditions: Conditions
) -> None:
    """A limit is judged once, on all paths for which no later rule replaces it."""
    limits = parse_limits(
        f"[limits]\nwork_ms_p99 = {{ max = 10.0, {THIS} }}\n"
        f'[[for]]\ntrace = "walk-2"\nlimits = {{ work_ms_p99 = {{ max = 50.0, {THIS} }} }}'
    )
    now = make_measured([[8.0, 8.1], [9.0, 9.1], [40.0, 41.0]])
    report = judge_all(limits, [now], conditions, None)
    assert [(verdict.paths, verdict.outcome) for verdict in report.verdicts] == [
        (("walk-0", "walk-1"), "passes"),
        (("walk-2",), "passes"),
    ]


def test_too_few_replicates_are_bad_input(judge: Judge, make_measured: Make) -> None:
    """One seed shows no noise and one path no other, and nothing is judged by them."""
    with pytest.raises(InputError, match="expected 2 seeds or more to judge this-path by, got 1"):
        judge(f"max = 10.0, {THIS}", make_measured([[9.0], [9.1]]))
    with pytest.raises(InputError, match="expected 2 paths or more to judge such-paths by, got 1"):
        judge(f"max = 10.0, {SUCH}", make_measured([[9.0, 9.1]]))


def test_a_window_that_tells_nothing_is_bad_input(make_measured: Make) -> None:
    """An empty street, and full detail within the budget, are refused with the number."""
    require_load([make_measured(BASE)], 10.0)
    with pytest.raises(InputError, match="yard: on walk-0 nothing is in view for 60%"):
        require_load([make_measured(BASE, empty=0.6)], 10.0)
    with pytest.raises(InputError, match=r"takes 2.9 ms at most, within the budget of 10 ms"):
        require_load([make_measured(BASE, full_ms=2.9)], 10.0)


def test_strict_fails_what_is_undecided_or_never_applied(
    make_measured: Make, conditions: Conditions
) -> None:
    """Undecided passes unless strict; so does a rule for a policy that did not run."""
    unsure = [make_measured([[9.0, 11.0]])]
    one = parse_limits(f"[limits]\nwork_ms_p99 = {{ max = 10.0, {THIS} }}")
    assert judge_all(one, unsure, conditions, None).passed
    assert not judge_all(one, unsure, conditions, None, strict=True).passed
    sure = [make_measured([[9.0, 9.1]])]
    other = f'[[for]]\npolicy = "pdi"\nlimits.work_ms_p99 = {{ max = 10.0, {THIS} }}'
    two = parse_limits(f"[limits]\nwork_ms_p99 = {{ max = 12.0, {THIS} }}\n{other}")
    report: CheckReport = judge_all(two, sure, conditions, None)
    assert report.unused == ("policy pdi, scene *, trace *",)
    assert report.passed
    assert not judge_all(two, sure, conditions, None, strict=True).passed


def test_a_policy_without_scores(conditions: Conditions) -> None:
    """One that broke its contract fails, one that does not apply is undecided; both say why."""
    limits = parse_limits(f"[limits]\nwork_ms_p99 = {{ max = 10.0, {THIS} }}")
    broken = MeasuredPolicy("mine", "yard", ("walk",), ("h",), (), "frame 3: NaN", failed=True)
    unfit = replace(broken, reason="not applicable: a tree", failed=False)
    verdicts = judge_all(limits, [broken, unfit], conditions, None).verdicts
    assert [describe(verdict) for verdict in verdicts] == [
        "FAILS: mine in yard on walk: contract: frame 3: NaN",
        "undecided: mine in yard on walk: contract: not applicable: a tree",
    ]
