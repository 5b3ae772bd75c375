"""The tables of a comparison, as values that CSV and LaTeX both write."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ...metrics.metric import GROUPS, Metric
from ...metrics.metric_registry import METRICS, find_metric
from ...study.comparison import Comparison
from ...study.comparison_parts import PolicyResult, Score, Span
from ..summary import HEADLINE, knob_words, rank_text, shown_policies


@dataclass(frozen=True, slots=True)
class Estimate:
    """A value with its interval, if there is one."""

    value: float | None
    low: float | None = None
    high: float | None = None


Cell = str | bool | int | float | Estimate | None


@dataclass(frozen=True, slots=True)
class Column:
    """A column: its name, whether cells are estimates, and a unit that the name does not tell."""

    head: str
    estimates: bool = False
    unit: str = ""


@dataclass(frozen=True, slots=True)
class PrintedTable:
    """A table.

    Attributes
    ----------
    name : str
        Of its file.
    caption : str
        What it shows, in a sentence.
    """

    name: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]


def printed_tables(comparison: Comparison) -> list[PrintedTable]:
    """Return every table of a comparison that has a row."""
    tables = [
        _ranking(comparison),
        *(_metrics(comparison, group) for group in GROUPS),
        _chances(comparison),
        _curves(comparison),
        _budgets(comparison),
        _costs(comparison),
        _steps(comparison),
        _worst_moments(comparison),
        _unscored(comparison),
    ]
    return [table for table in tables if table.rows]


def _ranking(comparison: Comparison) -> PrintedTable:
    metrics = [find_metric(column.metric) for column in HEADLINE]
    heads = (
        "rank",
        "behind by",
        "policy",
        "knob",
        "same as",
        "p keeps",
        "kept",
        "paths",
        "work ms",
    )
    return PrintedTable(
        "ranking",
        f"Policies under a budget of {comparison.budget_ms:.4g} ms in {comparison.scene}, by rank; "
        f"work is that at {1.0 - comparison.miss:.0%} of the time.",
        (*map(Column, heads), *_metric_columns(metrics)),
        tuple(
            (
                rank_text(policy),
                policy.behind_by,
                policy.label,
                knob_words(policy),
                policy.same_as,
                *_keeps(policy),
                *_estimates(policy, metrics),
            )
            for policy in comparison.ok
        ),
    )


def _keeps(policy: PolicyResult) -> tuple[Cell, ...]:
    keeps = policy.keeps_budget
    if keeps is None:
        return (None,) * 4
    return keeps.probability, keeps.kept, keeps.paths, keeps.work_ms


def _metrics(comparison: Comparison, group: str) -> PrintedTable:
    metrics = [metric for metric in METRICS if metric.group == group]
    return PrintedTable(
        f"metrics-{group}",
        f"Metrics of {group}, with {comparison.sampling.level:.0%} intervals.",
        (Column("policy"), *_metric_columns(metrics)),
        tuple(
            (policy.label, *_estimates(policy, metrics)) for policy in shown_policies(comparison)
        ),
    )


def _metric_columns(metrics: Iterable[Metric]) -> Iterator[Column]:
    for metric in metrics:
        told = {metric.unit, *metric.id.split("_")} & {"ms", "px", "fraction", "ratio", "s"}
        yield Column(metric.id, estimates=True, unit="" if told else metric.unit)


def _estimates(policy: PolicyResult, metrics: Iterable[Metric]) -> Iterator[Estimate]:
    for metric in metrics:
        score = policy.metrics.get(metric.id)
        yield Estimate(None) if score is None else Estimate(score.value, *_span(score))


def _span(score: Score) -> Span | tuple[None, None]:
    """Return the interval over such paths, else of this one."""
    return score.such_paths or score.this_path or (None, None)


def _chances(comparison: Comparison) -> PrintedTable:
    overall = comparison.p_best, comparison.p_near_best, comparison.regret
    by_metric = [
        (metric, (chances.p_best, chances.p_near_best, chances.regret))
        for metric, chances in comparison.chances.items()
    ]
    return PrintedTable(
        "chances",
        "Probability of being the best, and near it, and the expected distance from it, on "
        f"{comparison.population}.",
        tuple(map(Column, ("order", "policy", "p best", "p near best", "regret"))),
        tuple(
            (order, label, *(side.get(label) for side in sides))
            for order, sides in (("whole", overall), *by_metric)
            for label in sides[0]
        ),
    )


def _curves(comparison: Comparison) -> PrintedTable:
    heads = ("policy", "knob")
    measured = ("work ms", "visible error px")
    rows: list[tuple[Cell, ...]] = []
    for label, curve in comparison.curve.items():
        none: tuple[tuple[None, None], ...] = ((None, None),) * len(curve.knob)
        for i, knob in enumerate(curve.knob):
            work = Estimate(curve.work_ms[i], *(curve.work_span or none)[i])
            error = Estimate(curve.visible_error_px[i], *(curve.visible_error_span or none)[i])
            rows.append((label, knob, work, error, curve.pops_per_s[i], curve.lag_ms[i]))
    return PrintedTable(
        "curves",
        "What each policy gives as its knob turns; work is that at "
        f"{1.0 - comparison.miss:.0%} of the time.",
        (
            *map(Column, heads),
            *(Column(head, estimates=True) for head in measured),
            *map(Column, ("visible pops per s", "lag ms")),
        ),
        tuple(rows),
    )


def _budgets(comparison: Comparison) -> PrintedTable:
    robustness = comparison.robustness
    return PrintedTable(
        "budgets",
        "Who comes first at other budgets, read off the curves.",
        tuple(map(Column, ("refresh Hz", "budget ms", "first", "does not reach it"))),
        tuple(
            (at.refresh_hz, at.budget_ms, ", ".join(at.first), ", ".join(at.misses))
            for at in (() if robustness is None else robustness.budgets)
        ),
    )


def _costs(comparison: Comparison) -> PrintedTable:
    robustness = comparison.robustness
    return PrintedTable(
        "costs",
        "Who comes first with costs that nobody measured, read off the curves.",
        tuple(map(Column, ("with", "the first stands", "first", "does not reach it"))),
        tuple(
            (item.cost, item.stands, ", ".join(item.first), ", ".join(item.misses))
            for item in (() if robustness is None else robustness.costs)
        ),
    )


def _steps(comparison: Comparison) -> PrintedTable:
    heads = ("policy", "time ms", "load before ms", "load after ms", "settles in ms", "settled")
    return PrintedTable(
        "steps",
        "Answers to steps in the load of the first path; what has not settled took at least so "
        "long.",
        tuple(map(Column, (*heads, "overshoot ratio"))),
        tuple(
            (
                policy.label,
                step.time_ms,
                step.load_before_ms,
                step.load_after_ms,
                step.settle_ms,
                step.settled,
                step.overshoot_ratio,
            )
            for policy in shown_policies(comparison)
            for step in policy.steps
        ),
    )


def _worst_moments(comparison: Comparison) -> PrintedTable:
    heads = ("policy", "path", "time s", "x m", "y m", "z m", "work ms", "usual ms", "grown term")
    return PrintedTable(
        "worst-moments",
        "When each policy worked longest, against its usual work, and the term that grew most.",
        tuple(map(Column, (*heads, "grown ms"))),
        tuple(
            (
                label,
                moment.path,
                moment.time_s,
                *moment.camera_m,
                moment.work_ms,
                moment.usual_ms,
                moment.term,
                moment.grown_ms,
            )
            for label, moment in comparison.worst_moments.items()
        ),
    )


def _unscored(comparison: Comparison) -> PrintedTable:
    return PrintedTable(
        "unscored",
        "Policies that have no scores, and why.",
        tuple(map(Column, ("policy", "status", "reason"))),
        tuple(
            (policy.label, policy.status, policy.reason)
            for policy in comparison.policies
            if policy.status != "ok"
        ),
    )
