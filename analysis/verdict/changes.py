"""What changed from one comparison to another beyond noise, and which cost went with it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields
from itertools import chain
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from scipy.special import stdtr, stdtrit

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...sim.frame_log import UNLOGGED, FrameLog
from ..metrics.metric import Better
from ..metrics.metric_registry import find_metric
from ..study.comparison import Comparison
from ..study.comparison_parts import Conditions, PolicyResult, knob_text
from .paired import holm

if TYPE_CHECKING:
    import pyarrow as pa

    from ..study.comparison_folder import Compared

WATCHED = (
    *("work_ms_p99", "work_ms_mean", "over_budget_time_fraction"),
    *("visible_error_px", "visible_pops_per_s", "lag_ms_mean"),
)
"""Metrics whose change is told."""

_ALPHA = 0.05
"""Chance that any change of all is told although there is none."""

_ByPath: TypeAlias = Mapping[str, Mapping[str, FloatArray]]
_Values: TypeAlias = Mapping[str, _ByPath]
_Side: TypeAlias = Literal["gpu", "cpu"]
_Term: TypeAlias = tuple[_Side, str]


@dataclass(frozen=True, slots=True)
class Change:
    """A metric of a policy in both comparisons.

    Attributes
    ----------
    before, after : float
        Means over the paths.
    low, high : float
        90 % interval of after − before: on the same paths under other noise, else over such paths.
    beyond_noise : bool
        Whether the change is shown, all changes of the comparison together considered (Holm).
    """

    policy: str
    metric: str
    unit: str
    better: Better
    before: float
    after: float
    low: float
    high: float
    beyond_noise: bool


@dataclass(frozen=True, slots=True)
class PolicyChange:
    """What of a policy's place changed.

    Attributes
    ----------
    rank_before, rank_after : int or None
        None where it does not keep the budget.
    knob_before, knob_after : str
    term : str
        The predictor whose cost a frame changed most on the first path; empty if none did.
    side : "gpu" or "cpu"
        Whose cost that is.
    term_ms : float
        By how much: counts times what one of them costs, after less before.
    """

    policy: str
    rank_before: int | None
    rank_after: int | None
    knob_before: str
    knob_after: str
    term: str
    side: _Side
    term_ms: float


@dataclass(frozen=True, slots=True)
class Changes:
    """The changes from one comparison to another.

    Attributes
    ----------
    paired : bool
        Whether both have the same paths, which are then compared one by one.
    conditions : tuple of str
        What else differs, such as the budget: changes may be of that.
    only_before, only_after : tuple of str
        Labels of policies that were scored in one alone.
    """

    paired: bool
    conditions: tuple[str, ...]
    policies: tuple[PolicyChange, ...]
    metrics: tuple[Change, ...]
    only_before: tuple[str, ...]
    only_after: tuple[str, ...]
    schema: Literal["lodbench.compare-changes/2"] = "lodbench.compare-changes/2"


def find_changes(before: "Compared", after: "Compared") -> Changes:
    """Return what changed from one comparison to another.

    Raises `InputError` if one lacks its runs, or no policy was scored in both.
    """
    then, now = _by_label(before), _by_label(after)
    both = [label for label in then if label in now]
    if not both:
        raise InputError("compare: expected a policy that both folders scored, got none in common")
    values_then, values_now = _values(before), _values(after)
    paired = all(_are_paired(values_then[label], values_now[label]) for label in both)
    found = [
        (label, metric, *_test(values_then[label], values_now[label], metric, paired=paired))
        for label in both
        for metric in WATCHED
    ]
    shown = holm([row[-1] for row in found], _ALPHA)
    metrics = tuple(
        _change(label, metric, *numbers, beyond_noise=bool(beyond))
        for (label, metric, *numbers, _), beyond in zip(found, shown, strict=True)
        if not np.isnan(numbers[0])
    )
    return Changes(
        paired=paired,
        conditions=tuple(_differing(before.comparison, after.comparison)),
        policies=tuple(
            _policy_change(
                then[label], now[label], _terms_ms(before, label), _terms_ms(after, label)
            )
            for label in both
        ),
        metrics=metrics,
        only_before=tuple(label for label in then if label not in now),
        only_after=tuple(label for label in now if label not in then),
    )


def _differing(before: Comparison, after: Comparison) -> Iterator[str]:
    """Yield what the comparisons were made under that is not the same."""
    for name in ("scene", "hardware", "budget_ms", "miss", "visible", "margin"):
        then, now = getattr(before, name), getattr(after, name)
        if then != now:
            yield f"{name} {then}, now {now}"
    for item in fields(Conditions):
        then, now = (getattr(side.conditions, item.name) for side in (before, after))
        if then != now:
            yield f"{item.name} {then}, now {now}"
    same_name = before.hardware == after.hardware
    hashes = [side.provenance.hashes.get(f"hardware {side.hardware}") for side in (before, after)]
    if same_name and hashes[0] != hashes[1]:
        yield f"hardware {after.hardware} has other numbers"


def _by_label(compared: "Compared") -> dict[str, PolicyResult]:
    return {policy.label: policy for policy in compared.comparison.ok}


def _values(compared: "Compared") -> _Values:
    """Return by label and path each metric under each seed, (S,), of the runs that judge."""
    if compared.runs is None:
        raise InputError("compare: expected a folder with runs.parquet, got one without; run again")
    table: pa.Table = compared.runs
    rows = table.select(["policy", "trace_hash", "judged", "draw", *WATCHED]).to_pylist()
    found: dict[str, dict[str, list[dict[str, Any]]]] = {}
    for row in rows:
        if row["judged"] and row["draw"] is None:
            found.setdefault(row["policy"], {}).setdefault(row["trace_hash"], []).append(row)
    return {
        label: {
            path: {name: np.array([run[name] for run in runs], np.float64) for name in WATCHED}
            for path, runs in paths.items()
        }
        for label, paths in found.items()
    }


def _are_paired(then: _ByPath, now: _ByPath) -> bool:
    """Whether both have the same paths under as many seeds."""
    counts = [{path: len(of[WATCHED[0]]) for path, of in by.items()} for by in (then, now)]
    return counts[0] == counts[1]


def _test(
    then: _ByPath, now: _ByPath, metric: str, *, paired: bool
) -> tuple[float, float, float, float, float]:
    """Return both means, the ends of the interval of their difference, and its two-sided p.

    On the same paths it is the noise that must be exceeded: each path is compared with itself under
    the same seeds, and how the change differs from path to path is no doubt of it.
    """
    before = {path: of[metric] for path, of in then.items()}
    after = {path: of[metric] for path, of in now.items()}
    by_path = [np.array([of.mean() for of in side.values()]) for side in (after, before)]
    means = float(by_path[1].mean()), float(by_path[0].mean())
    if not np.isfinite(means).all():
        return (*means, np.nan, np.nan, np.nan)
    changes = [after[path] - before[path] for path in before] if paired else []
    several = paired and all(len(change) > 1 for change in changes)
    if several:
        samples, share = changes, 1.0 / len(changes)
    elif paired:
        samples, share = [np.concatenate(changes)], 1.0
    else:
        samples, share = by_path, 1.0
    if min(map(len, samples)) < 2:
        return (*means, np.nan, np.nan, np.nan)
    change = means[1] - means[0]
    error, degrees = _error(samples)
    error *= share
    if error == 0.0:  # the same in every replay, whatever it is
        return (*means, change, change, 1.0 if change == 0.0 else 0.0)
    reach = float(stdtrit(degrees, 0.95)) * error
    p = 2.0 * float(stdtr(degrees, -abs(change) / error))
    return *means, change - reach, change + reach, p


def _error(samples: list[FloatArray]) -> tuple[float, float]:
    """Return the standard error of a sum or difference of means, and its degrees of freedom.

    Source: Welch, Biometrika 34 (1947).
    """
    # Spread within rounding of the values is none.
    spread = [np.ptp(of) > 1e-12 * np.abs(of).max() for of in samples]
    errors = [
        float(of.var(ddof=1)) / len(of) if wide else 0.0
        for of, wide in zip(samples, spread, strict=True)
    ]
    total = sum(errors)
    if total == 0.0:
        return 0.0, 1.0
    below = sum(error**2 / (len(of) - 1) for error, of in zip(errors, samples, strict=True))
    return total**0.5, total**2 / below


def _change(
    label: str,
    metric: str,
    before: float,
    after: float,
    low: float,
    high: float,
    *,
    beyond_noise: bool,
) -> Change:
    of = find_metric(metric)
    return Change(label, metric, of.unit, of.better, before, after, low, high, beyond_noise)


def _terms_ms(compared: "Compared", label: str) -> dict[_Term, float]:
    """Return what each term costs a frame on the first path, in the mean."""
    log, costs = compared.logs[label], compared.comparison.unit_costs
    return dict(chain(_side_ms(log, "gpu", costs.gpu), _side_ms(log, "cpu", costs.cpu)))


def _side_ms(
    log: FrameLog, side: _Side, unit_ms: Mapping[str, float]
) -> Iterator[tuple[_Term, float]]:
    for name, ms in unit_ms.items():
        if name in UNLOGGED:  # the same in every frame, and no column of a log
            continue
        mean = float(log[name].mean())
        if np.isfinite(mean):
            yield (side, name), ms * mean


def _policy_change(
    then: PolicyResult,
    now: PolicyResult,
    ms_then: Mapping[_Term, float],
    ms_now: Mapping[_Term, float],
) -> PolicyChange:
    changed = {
        term: ms_now.get(term, 0.0) - ms_then.get(term, 0.0) for term in {**ms_then, **ms_now}
    }
    side, name = max(changed, key=lambda term: abs(changed[term]), default=("gpu", ""))
    term_ms = changed.get((side, name), 0.0)
    return PolicyChange(
        policy=now.label,
        rank_before=then.rank,
        rank_after=now.rank,
        knob_before=knob_text(then),
        knob_after=knob_text(now),
        term=name if term_ms else "",
        side=side,
        term_ms=term_ms,
    )
