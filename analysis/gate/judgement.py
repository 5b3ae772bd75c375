"""The verdict on one limit, and what makes it plain."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..metrics.metric_registry import find_metric
from ..metrics.worst_moment import Moment
from ..study.replays import noise_seed
from ..verdict.paired import Judgement
from .evidence import Finding, Question, allowed_of, amount_of, is_extreme, worst_of
from .limits import Limit
from .measurements import Conditions, MeasuredPolicy

Outcome = Literal["passes", "fails", "undecided"]
_OUTCOMES: dict[str, Outcome] = {"pass": "passes", "fail": "fails", "undecided": "undecided"}
_UNIT = {"this-path": "seeds", "such-paths": "paths"}


@dataclass(frozen=True, slots=True)
class Change:
    """What a metric became against the baseline.

    Attributes
    ----------
    baseline : float
        Mean of the same runs.
    value, bound : float
        Of the change, and the end of its one-sided 95 % interval towards the worse, in `unit`:
        "%" of the baseline, or the metric's own where that is 0.
    """

    baseline: float
    value: float
    bound: float
    unit: str


@dataclass(frozen=True, slots=True)
class Worst:
    """The run that is worst by a metric, and the moment of most work in it."""

    seed: int
    value: float
    moment: Moment


@dataclass(frozen=True, slots=True)
class Verdict:
    """One limit on one policy in one scene, on the paths that it is for.

    Attributes
    ----------
    population : "this-path", "such-paths", "observed" or ""
        Of what the limit was judged; observed where it is on an extreme, empty where a policy
        failed before any limit was judged.
    limit : str
        As the file says it, and in milliseconds what is not.
    line : int or None
        Where the file says it.
    value : float or None
        Mean over the runs; of an extreme the worst of all.
    bound : float or None
        End of the one-sided 95 % interval of an absolute limit's mean, towards the limit.
    p : float or None
        That the limit is kept and what was seen is chance.
    needed : int or None
        Paths, or seeds on each path, that would decide.
    reason : str or None
        Why nothing could be decided, or why the policy failed.
    """

    policy: str
    scene: str
    paths: tuple[str, ...]
    metric: str
    population: str
    outcome: Outcome
    limit: str
    line: int | None = None
    value: float | None = None
    bound: float | None = None
    unit: str = ""
    p: float | None = None
    change: Change | None = None
    needed: int | None = None
    reason: str | None = None
    worst: Worst | None = None

    @property
    def needed_text(self) -> str:
        """How many of what would decide, in words; empty if that is not known."""
        return "" if self.needed is None else f"{self.needed} {_UNIT[self.population]}"


def judge_failure(measured: MeasuredPolicy) -> Verdict:
    """Return the verdict on a policy without scores: it broke its contract, or does not apply."""
    outcome: Outcome = "fails" if measured.failed else "undecided"
    where = measured.policy, measured.scene, measured.paths
    return Verdict(*where, "contract", "", outcome, "", reason=measured.reason)


def conclude(
    question: Question,
    finding: Finding,
    judgement: Judgement,
    conditions: Conditions,
    *,
    allow_new: bool,
) -> Verdict:
    """Return the verdict on a question, with what makes it plain."""
    limit, measured = question.limit, question.measured
    extreme = is_extreme(limit)
    outcome, reason = _OUTCOMES[judgement.verdict], finding.reason
    if finding.missing:
        outcome = "passes" if allow_new else "fails"
        advice = "new, which --allow-new allows" if allow_new else "update it, or --allow-new"
        reason = f"{reason}; {advice}"
    value = bound = None
    if finding.now.size and not np.isnan(finding.now).all():
        value = float(np.nanmean(finding.now)) if not extreme else worst_of(limit, finding.now)
    if not limit.relative and not extreme and np.isfinite(judgement.high):
        sign = 1.0 if limit.upper else -1.0
        bound = amount_of(limit, conditions) + sign * judgement.high
    return Verdict(
        policy=measured.policy,
        scene=measured.scene,
        paths=tuple(measured.paths[path] for path in question.at),
        metric=limit.metric,
        population="observed" if extreme else limit.population,
        outcome=outcome,
        limit=limit.describe(conditions.budget_ms, conditions.refresh_hz),
        line=limit.line,
        value=value,
        bound=bound,
        unit=find_metric(limit.metric).unit,
        p=None if extreme or np.isnan(judgement.p) else judgement.p,
        change=_change(limit, finding, judgement, conditions),
        needed=judgement.needed,
        reason=reason,
        worst=None if outcome == "passes" else _find_worst(question, conditions.seed),
    )


def _change(
    limit: Limit, finding: Finding, judgement: Judgement, conditions: Conditions
) -> Change | None:
    now, then = finding.now, finding.then
    if then is None or not then.size:
        return None
    base, sign = float(then.mean()), 1.0 if limit.upper else -1.0
    scale, unit = (100.0 / abs(base), "%") if base else (1.0, find_metric(limit.metric).unit)
    allowed = float(allowed_of(limit, then, conditions).mean())
    bound = sign * (judgement.high + allowed)
    return Change(base, scale * (float(now.mean()) - base), scale * bound, unit)


def _find_worst(question: Question, first_seed: int) -> Worst | None:
    """Return the run that is worst by the metric."""
    now = question.measured.values(question.limit.metric)[list(question.at)]
    if np.isnan(now).all():
        return None
    flat = np.nanargmax(now if question.limit.upper else -now)
    path, seed = np.unravel_index(int(flat), now.shape)
    run = question.measured.runs[question.at[int(path)]][int(seed)]
    of_noise = noise_seed(first_seed + int(seed), question.at[int(path)])
    return Worst(of_noise, float(now[path, seed]), run.worst)
