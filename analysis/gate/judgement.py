"""Whether a limit holds, judged on the interval, and on the value where there is no interval."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...base.arrays import FloatArray
from .baseline import Baseline
from .limits import Limit
from .measurements import Conditions, MeasuredPolicy, interval
from .worst_frame import WorstFrame, find_worst

Outcome = Literal["passes", "fails", "undecided"]

_MORE = "run more seeds"


@dataclass(frozen=True, slots=True)
class Change:
    """What a metric became against the baseline.

    Attributes
    ----------
    baseline : float
    value, low, high : float
        Of the change, in `unit`: "%" of the baseline, or the metric's own where that is 0.
    """

    baseline: float
    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True, slots=True)
class Verdict:
    """One limit on one policy in one scene on one trace.

    Attributes
    ----------
    limit : str
        As the file says it, and in milliseconds what is not; empty where a policy failed before
        any limit was judged.
    line : int or None
        Where the file says it.
    value, low, high : float or None
    reason : str or None
        Why nothing could be decided, or why the policy failed.
    """

    policy: str
    scene: str
    trace: str
    metric: str
    outcome: Outcome
    limit: str
    line: int | None = None
    value: float | None = None
    low: float | None = None
    high: float | None = None
    unit: str = ""
    change: Change | None = None
    reason: str | None = None
    worst: WorstFrame | None = None


def judge_failure(measured: MeasuredPolicy) -> Verdict:
    """Return the verdict on a policy without scores: it broke its contract, or does not apply."""
    outcome: Outcome = "fails" if measured.failed else "undecided"
    return Verdict(*measured.case, "contract", outcome, "", reason=measured.reason)


def judge(
    limit: Limit, measured: MeasuredPolicy, conditions: Conditions, baseline: Baseline | None
) -> Verdict:
    """Return whether a limit holds for a measured policy.

    It fails if the whole interval lies beyond the limit, passes if none of it does, and is
    undecided in between.  One replicate has no interval: then the value decides.
    """
    score = measured.scores[limit.metric]
    change: Change | None = None
    if limit.relative:
        outcome, reason, change = _relative(limit, measured, conditions, baseline)
    else:
        bound = limit.amount.resolve(conditions.budget_ms, conditions.refresh_hz)
        sign = 1.0 if limit.kind == "max" else -1.0
        ends = (score.low, score.high) if sign > 0.0 else (score.high, score.low)
        outcome, reason = _absolute(score.value, ends, sign, bound)
    worst = None
    if score.value is not None:
        worst = find_worst(measured.logs, conditions.warmup_s, limit.metric)
    text = limit.describe(conditions.budget_ms, conditions.refresh_hz)
    judged = (*measured.case, limit.metric, outcome, text, limit.line)
    return Verdict(*judged, score.value, score.low, score.high, score.unit, change, reason, worst)


def _absolute(
    value: float | None, ends: tuple[float | None, float | None], sign: float, bound: float
) -> tuple[Outcome, str | None]:
    """Judge an interval from its better to its worse end."""
    better, worse = ends
    if value is None:
        return "undecided", "the run has no value: nothing of the kind happened"
    if better is None or worse is None:
        better = worse = value
    return _decide(sign * (better - bound), sign * (worse - bound))


def _decide(better: float, worse: float) -> tuple[Outcome, str | None]:
    """Judge how far both ends of an interval are beyond a limit."""
    if better > 0.0:
        return "fails", None
    return ("passes", None) if worse <= 0.0 else ("undecided", _MORE)


def _relative(
    limit: Limit, measured: MeasuredPolicy, conditions: Conditions, baseline: Baseline | None
) -> tuple[Outcome, str | None, Change | None]:
    """Judge the change from the baseline, seed by seed."""
    score = measured.scores[limit.metric]
    before = None if baseline is None else baseline.find(measured, limit.metric)
    if before is None:
        return "undecided", "the baseline has no such value; update it", None
    base, then = before
    values = [value for value in measured.by_seed[limit.metric] if value is not None]
    if score.value is None or len(values) < len(then):
        return "undecided", f"not every seed has a value; {_MORE}", None
    difference = np.array(values) - then
    rise = difference if limit.kind == "max_increase" else -difference
    better, worse = _ends(rise - _allowed(limit, conditions, then))
    share = 100.0 / abs(base) if base else 1.0
    low, high = _ends(share * difference)
    unit = "%" if base else score.unit
    change = Change(base, share * (score.value - base), low, high, unit)
    return (*_decide(better, worse), change)


def _allowed(limit: Limit, conditions: Conditions, then: FloatArray) -> FloatArray:
    """Return by how much the value under each seed may change."""
    amount = limit.amount.resolve(conditions.budget_ms, conditions.refresh_hz)
    allowed = (
        amount * np.abs(then) if limit.amount.measure == "share" else np.full_like(then, amount)
    )
    if limit.floor is None:
        return allowed
    return np.maximum(allowed, limit.floor.resolve(conditions.budget_ms, conditions.refresh_hz))


def _ends(values: FloatArray) -> tuple[float, float]:
    """Return the ends of the interval of a mean over seeds; of one seed, its value twice."""
    low, high = interval(values.tolist())
    if low is None or high is None:
        return float(values[0]), float(values[0])
    return low, high
