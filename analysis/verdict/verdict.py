"""The verdict: who keeps the budget, who of those is better by what can be seen, how surely."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray
from ..metrics.worst_moment import Moment
from ..study.comparison_parts import (
    Chances,
    Costlier,
    Curve,
    Elsewhere,
    Keeps,
    LeastMiss,
    PolicyResult,
    Robustness,
)
from . import chances as chances_of
from . import curve as curves_of
from .answer import ORDER, SEEN, answer
from .criterion import LAG_MARGIN_MS, PICTURE_MARGIN_PX, POPS_MARGIN_PER_S, Criterion
from .folding import fold_identical
from .folds import folds
from .judged import Judged
from .keeping import keeping, p_keeps, p_keeps_with_machine
from .operating_point import SURE
from .ranking import RankGroup, ranking
from .robustness import robustness
from .scores import LEVEL, score_metrics
from .warnings import find_warnings

LEAST = {
    "missing_objects_mean": 0.01,
    "visible_error_px": PICTURE_MARGIN_PX,
    "visible_pops_per_s": POPS_MARGIN_PER_S,
    "lag_ms_mean": LAG_MARGIN_MS,
    "work_ms_mean": 0.0,
}
"""Differences that decide nothing, in the unit of each metric of the order."""
_NO_PICTURE_PX = 1_000.0


@dataclass(frozen=True, slots=True)
class Terms:
    """By what a verdict is reached.

    Attributes
    ----------
    budget_ms : float
    margin : float
        Part of the best's value within which another is as good.
    population : str
        What probabilities are about, in words that follow "on".
    paths : tuple of str
        Names of the judged paths.
    seed : int
        Of the draws behind probabilities.
    """

    budget_ms: float
    margin: float
    population: str
    paths: tuple[str, ...]
    seed: int


@dataclass(frozen=True, slots=True)
class Verdict:
    """What a comparison says; fields as those of `Comparison`."""

    policies: tuple[PolicyResult, ...]
    order: Chances
    chances: dict[str, Chances]
    least_miss: LeastMiss | None
    curves: dict[str, Curve]
    worst_moments: dict[str, Moment]
    robustness: Robustness | None
    warnings: tuple[str, ...]
    answer: tuple[str, str, str]


def reach_verdict(
    judged: Sequence[Judged],
    unscored: Sequence[PolicyResult],
    curves: Mapping[str, curves_of.Curve],
    terms: Terms,
) -> Verdict:
    """Return the verdict on policies.

    Parameters
    ----------
    judged
        Those that were scored.
    unscored
        Those that failed or do not apply.
    curves
        By label, of those that were tuned.
    """
    by_label = {item.label: item for item in judged}
    keeps = {label: _keeps(item, terms.budget_ms) for label, item in by_label.items()}
    same = _same(judged)
    surely = {label for label, item in keeps.items() if _is_sure(item)}
    rivals = [item for item in judged if item.label in surely - same.keys() and not item.oracle]
    criteria = order_criteria(rivals, terms.margin)
    groups = ranking([item.label for item in rivals], criteria) if rivals else ()
    results = [_result(item, keeps[item.label], same) for item in judged]
    policies = (*_in_order(results, groups, terms.budget_ms), *unscored)
    order, sure = _chances(rivals, criteria, terms.seed)
    nearest = None if groups else _least_miss(judged, terms.budget_ms)
    apart = {label: curve for label, curve in curves.items() if label not in same}
    stands = _robustness(apart, terms)
    contenders = [item for item in judged if not item.oracle]
    most = max(judged, key=lambda item: len(item.runs), default=None)  # an oracle has few paths
    footings = [] if most is None else [seeds[0].footing for seeds in most.runs]
    return Verdict(
        policies=policies,
        order=order,
        chances=sure,
        least_miss=nearest,
        curves=_shown_curves(curves, groups),
        worst_moments={item.label: _worst(item) for item in judged},
        robustness=stands,
        warnings=find_warnings(
            terms.paths[: len(footings)],
            footings,
            terms.budget_ms,
            [item.label in surely for item in contenders],
        ),
        answer=answer(policies, terms.budget_ms, order, nearest, stands, terms.population),
    )


def order_criteria(rivals: Sequence[Judged], margin: float) -> tuple[Criterion, ...]:
    """Return the metrics of the order, on the paths where every rival has all of them, (P, n)."""
    if not rivals:
        return ()
    tables = {name: np.array([item.replicates(name) for item in rivals]) for name in ORDER}
    error = tables["visible_error_px"]
    # Who draws nothing where others draw has no error of its own, and no picture is worse.
    drawn_by_some = ~np.isnan(error).all(axis=0)
    tables["visible_error_px"] = np.where(np.isnan(error) & drawn_by_some, _NO_PICTURE_PX, error)
    known = ~np.isnan(np.array(list(tables.values()))).any(axis=(0, 1))
    if not known.any():  # nothing was ever in view: only what it took can be told apart
        return (Criterion("work_ms_mean", tables["work_ms_mean"], relative=margin),)
    return tuple(
        Criterion(name, table[:, known], relative=margin, absolute=LEAST[name])
        for name, table in tables.items()
    )


def _keeps(item: Judged, budget_ms: float) -> Keeps:
    probability = p_keeps(item.point_ms, budget_ms)
    judged = keeping(item.judged_ms, budget_ms, LEVEL)
    known = not np.isnan(probability)
    unsure = known and len(item.drawn) > 1
    return Keeps(
        probability=probability if known else None,
        kept=judged.kept,
        paths=judged.paths,
        low=judged.low,
        high=judged.high,
        work_ms=float(np.exp(np.log(item.point_ms).mean())),
        with_machine=(
            p_keeps_with_machine(item.point_ms, item.drawn_ms, budget_ms) if unsure else None
        ),
    )


def _is_sure(keeps: Keeps) -> bool:
    return keeps.kept == keeps.paths if keeps.probability is None else keeps.probability >= SURE


def _same(judged: Sequence[Judged]) -> dict[str, str]:
    """Return for each policy that did the same as another the label that stands for both."""
    alike = [item for item in judged if not item.oracle]
    if not alike:
        return {}
    ids = list(alike[0].runs[0][0].values)
    by_shape: dict[tuple[int, ...], list[Judged]] = {}
    for item in alike:
        by_shape.setdefault(item.values(ids[0]).shape, []).append(item)
    found: dict[str, str] = {}
    for items in by_shape.values():
        values = np.array([[item.values(name) for name in ids] for item in items])
        found |= fold_identical([item.label for item in items], values)
    return found


def _result(item: Judged, keeps: Keeps, same: Mapping[str, str]) -> PolicyResult:
    return PolicyResult(
        name=item.spec.name,
        label=item.label,
        params=item.spec.params,
        knob=item.knob,
        status="ok",
        reason=None,
        oracle=item.oracle,
        keeps_budget=keeps,
        same_as=same.get(item.label),
        metrics=score_metrics(item),
        steps=item.runs[0][0].steps,
    )


def _worst(item: Judged) -> Moment:
    moments = [run.worst for seeds in item.runs for run in seeds]
    return max(moments, key=lambda moment: moment.work_ms)


def _in_order(
    results: Sequence[PolicyResult], groups: Sequence[RankGroup], budget_ms: float
) -> list[PolicyResult]:
    """Return results by rank, then by how much they miss, oracles last; twins beside each other."""
    place = {label: (group, at) for group in groups for at, label in enumerate(group.members)}

    def ranked(result: PolicyResult) -> PolicyResult:
        stands_for = result.same_as or result.label
        if stands_for not in place:
            return result
        group, _ = place[stands_for]
        return replace(result, rank=group.rank, leader=group.leader, behind_by=group.behind_by)

    def key(result: PolicyResult) -> tuple[object, ...]:
        stands_for = result.same_as or result.label
        twin = result.same_as is not None
        if stands_for in place:
            group, at = place[stands_for]
            return (0, float(group.rank), at, stands_for, twin, result.label)
        keeps = result.keeps_budget
        ratio = keeps.work_ms / budget_ms if keeps is not None else np.inf
        return (2 if result.oracle else 1, ratio, 0, stands_for, twin, result.label)

    return sorted(map(ranked, results), key=key)


def _chances(
    rivals: Sequence[Judged], criteria: Sequence[Criterion], seed: int
) -> tuple[Chances, dict[str, Chances]]:
    """Return the chances in the order, and in each of its metrics; none from a single path."""
    if not rivals or criteria[0].values.shape[1] < 2:
        return Chances({}, {}, {}), {}
    labels = [item.label for item in rivals]

    def named(values: FloatArray) -> dict[str, float]:
        return dict(zip(labels, values.tolist(), strict=True))

    def shown(of: chances_of.Chances) -> Chances:
        return Chances(named(of.p_best), named(of.p_within_margin), named(of.regret))

    paths = len(rivals[0].runs)
    tuned = any(item.knob is not None and item.knob.tuned for item in rivals)
    # One path alone is judged at knobs that its noise had no part in.
    spread = chances_of.tuning_spread(len(folds(paths))) if tuned and paths > 1 else 1.0
    each = {
        item.name: shown(chances_of.chances(item, seed=seed, spread=spread)) for item in criteria
    }
    # What choosing wrongly costs is told in what is seen.
    order = chances_of.order_chances(criteria, seed=seed, regret_in=SEEN[0], spread=spread)
    return shown(order), each


def _least_miss(judged: Sequence[Judged], budget_ms: float) -> LeastMiss | None:
    ratios = {
        item.label: float(np.exp(np.log(item.point_ms / budget_ms).mean()))
        for item in judged
        if not item.oracle
    }
    label = min(ratios, key=ratios.__getitem__, default=None)
    return None if label is None else LeastMiss(label, ratios[label])


def _robustness(curves: Mapping[str, curves_of.Curve], terms: Terms) -> Robustness | None:
    if not curves or next(iter(curves.values())).p99_ms.shape[1] < 2:
        return None
    found = robustness(curves, terms.budget_ms, terms.margin, len(terms.paths))
    if not found.first or found.speed_low is None or found.speed_high is None:
        return None
    budgets = tuple(
        Elsewhere(hz, 1e3 / hz, first, found.misses[hz]) for hz, first in found.at_refresh.items()
    )
    leader = found.first[0]
    costs = tuple(
        Costlier(cost, leader in first, first, found.misses_with[cost])
        for cost, first in found.with_costs.items()
    )
    return Robustness(leader, (found.speed_low, found.speed_high), budgets, costs)


def _shown_curves(
    curves: Mapping[str, curves_of.Curve], groups: Sequence[RankGroup]
) -> dict[str, Curve]:
    first = next((group.leader for group in groups if group.leader in curves), None)
    reference = None if first is None else curves[first]
    return {label: _shown_curve(curve, reference) for label, curve in curves.items()}


def _shown_curve(curve: curves_of.Curve, reference: curves_of.Curve | None) -> Curve:
    def means(table: FloatArray) -> tuple[float, ...]:
        return tuple(table.mean(axis=1).tolist())

    several = curve.p99_ms.shape[1] > 1
    work, error = (
        tuple((of.low, of.high) for of in curve.interval(name)) if several else ()
        for name in ("p99_ms", "error_px")
    )
    area = None if reference is None else curves_of.area_between(reference, curve)
    return Curve(
        knob=tuple(curve.knob.tolist()),
        work_ms=tuple(np.exp(np.log(curve.p99_ms).mean(axis=1)).tolist()),
        visible_error_px=means(curve.error_px),
        pops_per_s=means(curve.pops_per_s),
        lag_ms=means(curve.lag_ms),
        work_span=work,
        visible_error_span=error,
        area_pct=area,
    )
