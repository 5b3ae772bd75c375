"""What the runs say of one limit: its replicates, and how far they are beyond it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ..metrics.metric_registry import find_metric
from ..verdict.metric_kinds import kind_of
from ..verdict.paired import FAIL_ALPHA, Evidence, as_observed, by_t
from ..verdict.promised import at_most
from .baseline import Baseline
from .limits import Limit
from .measurements import Conditions, MeasuredPolicy

_NO_VALUE = "no run has a value: nothing of the kind happened"


@dataclass(frozen=True, slots=True, eq=False)
class Question:
    """A limit, and the runs that it is for.

    Attributes
    ----------
    at : tuple of int
        Positions of the paths.
    """

    limit: Limit
    measured: MeasuredPolicy
    at: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """What the runs say of a question.

    Attributes
    ----------
    evidence : Evidence
    now, then : (n, S) float64
        Values that were judged; `then` is None of an absolute limit.
    reason : str or None
        Why there is no evidence.
    missing : bool
        Whether that is because the baseline lacks something.
    """

    evidence: Evidence
    now: FloatArray
    then: FloatArray | None = None
    reason: str | None = None
    missing: bool = False


def questions_of(measured: MeasuredPolicy, chosen: Sequence[tuple[Limit, ...]]) -> list[Question]:
    """Return each limit once with all paths that it is for, from the limits of each path."""
    where: dict[Limit, list[int]] = {}
    for path, limits in enumerate(chosen):
        for limit in limits:
            where.setdefault(limit, []).append(path)
    return [Question(limit, measured, tuple(at)) for limit, at in where.items()]


def find(
    question: Question, conditions: Conditions, baseline: Baseline | None, questions: int
) -> Finding:
    """Return what the runs say, with `questions` limits judged together.

    Raises `InputError` if there are too few seeds, or paths, for the limit's population.
    """
    limit, at = question.limit, question.at
    now = question.measured.values(limit.metric)[list(at)]
    alpha = FAIL_ALPHA / questions
    if is_extreme(limit):
        return _of_extreme(limit, now, conditions)
    _require_replicates(question, now)
    then = None
    if limit.relative:
        stored = _stored(question, baseline)
        if isinstance(stored, str):
            return Finding(_nothing(), now, reason=stored, missing=True)
        then = stored
    known = ~np.isnan(now).any(axis=1)
    if then is not None:
        known &= ~np.isnan(then).any(axis=1)
        then = then[known]
    now = now[known]
    if not len(now):
        return Finding(_nothing(), now, reason=_NO_VALUE)
    return Finding(_evidence(limit, now, then, conditions, alpha), now, then)


def is_extreme(limit: Limit) -> bool:
    """Whether a limit is on an extreme, which is judged as it was seen."""
    return kind_of(find_metric(limit.metric)) == "extreme"


def _require_replicates(question: Question, now: FloatArray) -> None:
    paths, seeds = now.shape
    limit, population = question.limit, question.limit.population
    got, what, option = (
        (seeds, "seeds", "--seeds") if population == "this-path" else (paths, "paths", "--paths")
    )
    if got < 2:
        raise InputError(
            f"{limit.metric}: expected 2 {what} or more to judge {population} by, got {got}; give "
            f"more with {option}, or name the other population"
        )


def _stored(question: Question, baseline: Baseline | None) -> FloatArray | str:
    if baseline is None:
        return "there is no baseline"
    found = [baseline.find(question.measured, path, question.limit.metric) for path in question.at]
    missing = next((one for one in found if isinstance(one, str)), None)
    return missing if missing is not None else np.array(found)


def _of_extreme(limit: Limit, now: FloatArray, conditions: Conditions) -> Finding:
    if np.isnan(now).all():
        return Finding(_nothing(), now, reason=_NO_VALUE)
    beyond = worst_of(limit, now) - amount_of(limit, conditions)
    return Finding(as_observed(beyond if limit.upper else -beyond), now)


def _evidence(
    limit: Limit, now: FloatArray, then: FloatArray | None, conditions: Conditions, alpha: float
) -> Evidence:
    """Return the evidence of values without gaps, (n, S)."""
    sign = 1.0 if limit.upper else -1.0
    if then is not None:
        beyond = sign * (now - then) - allowed_of(limit, then, conditions)
    else:
        beyond = sign * (now - amount_of(limit, conditions))
    if limit.population == "this-path":
        return by_t(beyond, alpha)
    if then is None and limit.upper:
        kind = kind_of(find_metric(limit.metric))
        return at_most(now.mean(axis=1), kind, amount_of(limit, conditions), alpha)
    return by_t(beyond.mean(axis=1), alpha)


def allowed_of(limit: Limit, then: FloatArray, conditions: Conditions) -> FloatArray:
    """Return by how much each value may change."""
    amount = amount_of(limit, conditions)
    share = limit.amount.measure == "share"
    allowed = amount * np.abs(then) if share else np.full_like(then, amount)
    if limit.floor is None:
        return allowed
    return np.maximum(allowed, limit.floor.resolve(conditions.budget_ms, conditions.refresh_hz))


def worst_of(limit: Limit, now: FloatArray) -> float:
    """Return the value of all that is worst by a limit."""
    return float(np.nanmax(now) if limit.upper else np.nanmin(now))


def amount_of(limit: Limit, conditions: Conditions) -> float:
    """Return what a limit allows, in the metric's unit; of a share, the share."""
    return limit.amount.resolve(conditions.budget_ms, conditions.refresh_hz)


def _nothing() -> Evidence:
    return Evidence(float("nan"), float("nan"), float("inf"))
