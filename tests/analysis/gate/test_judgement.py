"""Verdicts worked by hand from intervals, changes and floors."""

from dataclasses import replace

import pytest

from lodbench.analysis.gate.baseline import Baseline, make_baseline
from lodbench.analysis.gate.check_result import judge_all
from lodbench.analysis.gate.limits_file import parse_limits
from lodbench.analysis.gate.measurements import Conditions, MeasuredPolicy
from lodbench.analysis.gate.plain_text import describe
from lodbench.analysis.study.comparison import Score

CONDITIONS = Conditions("machine", 10.0, 50.0, 0, 5, 1.0, 1.0)


def measured(
    value: float | None,
    low: float | None = None,
    high: float | None = None,
    *,
    metric: str = "frame_ms_p99",
    by_seed: list[float | None] | None = None,
) -> MeasuredPolicy:
    """Build what was measured of one metric."""
    score = Score(value, low, high, "ms", "lower")
    values = {metric: [value] if by_seed is None else by_seed}
    return MeasuredPolicy("pid", "yard", "walk", None, False, {metric: score}, values)


def outcome(
    limit: str,
    now: MeasuredPolicy,
    before: MeasuredPolicy | None = None,
    metric: str = "frame_ms_p99",
) -> str:
    """Return the verdict on one limit."""
    limits = parse_limits(f"[limits]\n{metric} = {{ {limit} }}")
    baseline = None if before is None else make_baseline(CONDITIONS, [before], limits)
    (verdict,) = judge_all(limits, [now], CONDITIONS, baseline).verdicts
    return verdict.outcome


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [(9.0, 9.9, "passes"), (9.0, 10.0, "passes"), (9.0, 10.1, "undecided"), (10.1, 11.0, "fails")],
)
def test_a_largest_value_is_judged_on_the_interval(low: float, high: float, expected: str) -> None:
    """Below the limit passes, above it fails, across it is undecided, whatever the value."""
    assert outcome("max = 10.0", measured(10.5, low, high)) == expected
    assert outcome('max = "budget"', measured(10.5, low, high)) == expected
    assert outcome('max = "0.5 frames"', measured(10.5, low, high)) == expected
    mirrored = measured(-10.5, -high, -low)
    assert outcome("min = -10.0", mirrored) == expected


def test_what_has_no_interval_is_judged_by_its_value() -> None:
    """A run without any such event decides nothing; a single replicate is all that is known."""
    assert outcome("max = 10.0", measured(None)) == "undecided"
    assert outcome("max = 10.0", measured(3.0)) == "passes"
    assert outcome("max = 10.0", measured(10.5)) == "fails"


BASE: list[float | None] = [10.0, 10.0, 20.0, 20.0, 20.0]
BASE_MS = (10.0, 10.0, 20.0, 20.0, 20.0)


@pytest.mark.parametrize(
    ("factor", "limit", "expected"),
    [
        (1.00, 'max_increase = "0%"', "passes"),
        (1.05, 'max_increase = "2.5%"', "fails"),
        (1.05, 'max_increase = "5.1%"', "passes"),
        (1.05, 'max_increase = "2.5%", floor = 0.4', "fails"),
        (1.05, 'max_increase = "2.5%", floor = 1.1', "passes"),
        (1.05, 'max_increase = "1%", floor = 0.7', "undecided"),
        (1.05, 'max_increase = "0.06 frames"', "passes"),
        (1.05, "max_increase = 0.4", "fails"),
        (0.90, 'max_increase = "0%"', "passes"),
        (0.90, 'max_decrease = "5%"', "fails"),
        (0.90, 'max_decrease = "20%"', "passes"),
    ],
)
def test_changes_are_judged_pair_by_pair(factor: float, limit: str, expected: str) -> None:
    """5 % more in every pair is 5 % more, although the values of the pairs lie far apart."""
    now = measured(17.0, 9.0, 22.0, by_seed=[factor * x for x in BASE_MS])
    before = measured(16.0, 9.0, 22.0, by_seed=BASE)
    assert outcome(limit, now, before) == expected


def test_a_change_from_zero_is_in_the_metrics_unit() -> None:
    """Where the baseline is 0 any share of it is 0, and the change is told as it is."""
    metric = "toggles_per_s"
    before = measured(0.0, 0.0, 0.0, metric=metric, by_seed=[0.0] * 5)
    now = measured(0.2, 0.2, 0.2, metric=metric, by_seed=[0.2] * 5)
    limits = parse_limits(f'[limits]\n{metric} = {{ max_increase = "5%" }}')
    baseline = make_baseline(CONDITIONS, [before], limits)
    (verdict,) = judge_all(limits, [now], CONDITIONS, baseline).verdicts
    assert verdict.outcome == "fails"
    assert "+0.2 [+0.2, +0.2] ms on a baseline of 0" in describe(verdict)
    assert outcome('max_increase = "5%", floor = 0.3', now, before, metric) == "passes"


def test_a_seed_without_a_value_decides_nothing() -> None:
    """What happened under some seeds only cannot be paired with what happened under all."""
    before = measured(10.0, 9.0, 11.0, by_seed=[10.0] * 5)
    limit = 'max_increase = "5%"'
    assert outcome(limit, measured(12.0, by_seed=[12.0, None, 12.0, 12.0, 12.0]), before) == (
        "undecided"
    )
    assert outcome(limit, measured(12.0, by_seed=[12.0] * 5), before) == "fails"
    # Nor can a baseline that lacks one.
    lacks = measured(10.0, 9.0, 11.0, by_seed=[None, 10.0, 10.0, 10.0, 10.0])
    assert outcome(limit, measured(10.0, by_seed=[10.0] * 5), lacks) == "undecided"


def test_shares_of_a_negative_metric_are_of_its_size() -> None:
    """From -10 to -9.6 is an increase by 4 %, which 5 % allow and 2 % do not."""
    metric = "prediction_error_pct_mean"
    before = measured(-10.0, -10.0, -10.0, metric=metric, by_seed=[-10.0] * 5)
    now = measured(-9.6, -9.6, -9.6, metric=metric, by_seed=[-9.6] * 5)
    assert outcome('max_increase = "5%"', now, before, metric) == "passes"
    assert outcome('max_increase = "2%"', now, before, metric) == "fails"
    limits = parse_limits(f'[limits]\n{metric} = {{ max_increase = "2%" }}')
    baseline = make_baseline(CONDITIONS, [before], limits)
    (verdict,) = judge_all(limits, [now], CONDITIONS, baseline).verdicts
    assert "+4 [+4, +4] %" in describe(verdict)


def test_without_a_baseline_a_change_is_undecided() -> None:
    """A policy that the baseline does not know has not become worse."""
    now = measured(10.0, 9.0, 11.0, by_seed=BASE)
    assert outcome('max_increase = "5%"', now) == "undecided"
    limits = parse_limits('[limits]\nframe_ms_p99 = { max_increase = "5%" }')
    empty = Baseline(CONDITIONS)
    (verdict,) = judge_all(limits, [now], CONDITIONS, empty).verdicts
    assert "update it" in describe(verdict)


def test_strict_fails_what_is_undecided_or_never_applied() -> None:
    """Undecided passes unless strict; so does a rule for a policy that did not run."""
    limits = parse_limits("[limits]\nframe_ms_p99 = { max = 10.0 }")
    unsure = [measured(10.0, 9.0, 11.0)]
    assert judge_all(limits, unsure, CONDITIONS, None).passed
    assert not judge_all(limits, unsure, CONDITIONS, None, strict=True).passed
    other = '[[for]]\npolicy = "pdi"\nlimits.frame_ms_p99 = { max = 10.0 }'
    limits = parse_limits(f"[limits]\nframe_ms_p99 = {{ max = 12.0 }}\n{other}")
    assert judge_all(limits, unsure, CONDITIONS, None).unused == ("policy pdi, scene *, trace *",)
    assert judge_all(limits, unsure, CONDITIONS, None).passed
    assert not judge_all(limits, unsure, CONDITIONS, None, strict=True).passed


def test_a_policy_without_scores() -> None:
    """One that broke its contract fails, one that does not apply is undecided; both say why."""
    limits = parse_limits("[limits]\nframe_ms_p99 = { max = 10.0 }")
    broken = MeasuredPolicy("mine", "yard", "walk", "frame 3: NaN", failed=True)
    unfit = replace(broken, reason="not applicable: a tree", failed=False)
    verdicts = judge_all(limits, [broken, unfit], CONDITIONS, None).verdicts
    assert [describe(verdict) for verdict in verdicts] == [
        "FAILS: mine in yard on walk: contract: frame 3: NaN",
        "undecided: mine in yard on walk: contract: not applicable: a tree",
    ]
