"""The result of a comparison: records whose fields are the keys of ``comparison.json``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ...base.files.strict_json import read_json
from ...base.reader_guard import guarded
from ..metrics.metric_registry import METRICS
from ..metrics.worst_moment import Moment
from .comparison_parts import (
    Chances,
    Conditions,
    Curve,
    LeastMiss,
    PolicyResult,
    Provenance,
    Robustness,
    Sampling,
    Span,
    UnitCosts,
    knob_text,
)

if TYPE_CHECKING:
    import pyarrow as pa

SCHEMA = "lodbench.compare/2"

SHOWN = (
    "work_ms_p99",
    "visible_error_px",
    "visible_pops_per_s",
    "lag_ms_mean",
    "work_ms_mean",
)
"""Metrics by which policies are told apart: what a notebook shows of each."""


@dataclass(frozen=True, slots=True, repr=False)
class Comparison:
    """A comparison of policies, without any wall-clock time.

    Attributes
    ----------
    miss : float
        Share of time for which a policy may exceed the budget and still keep it.
    window_s : tuple of (from, to)
        Seconds of each path that count.
    population : str
        What probabilities and answer are about, in words that follow "on".
    visible : float
        Error, and change of error, in pixels, that counts as seen.
    margin : float
        Part of the best's value within which others are as good.
    warnings : tuple of str
        Why this comparison may not tell policies apart.
    answer : tuple of str
        Three sentences.
    policies : tuple of PolicyResult
        In the order of the answer: by rank, then those that miss by how much, oracles, the rest.
    p_best, p_near_best : dict of str to float
        By label of each policy that keeps the budget, the probability that on another such set of
        paths, or of a single path in other replays, it comes first in the order, or within the
        margin of the first; empty where there is a single replay.
    regret : dict of str to float
        Expected visible error above that of the best, in pixels.
    chances : dict of str to Chances
        The same in each metric of the order alone, by metric.
    least_miss : LeastMiss or None
        None where some policy keeps the budget.
    curve : dict of str to Curve
        By label, of the policies that were tuned.
    worst_moments : dict of str to Moment
        By label, when most work was done in any judged run.
    unit_costs : UnitCosts
        By which counts of frame logs are turned into time.
    """

    scene: str
    paths: tuple[str, ...]
    hardware: str
    budget_ms: float
    miss: float
    seed: int
    window_s: tuple[Span, ...]
    population: str
    visible: float
    margin: float
    conditions: Conditions
    sampling: Sampling
    warnings: tuple[str, ...]
    answer: tuple[str, ...]
    policies: tuple[PolicyResult, ...]
    p_best: dict[str, float]
    p_near_best: dict[str, float]
    regret: dict[str, float]
    chances: dict[str, Chances]
    least_miss: LeastMiss | None
    curve: dict[str, Curve]
    worst_moments: dict[str, Moment]
    robustness: Robustness | None
    unit_costs: UnitCosts
    provenance: Provenance
    schema: Literal["lodbench.compare/2"] = SCHEMA

    def __repr__(self) -> str:
        return f"<Comparison in {self.scene}, {self.budget_ms:.4g} ms: {self.answer[0]}>"

    def to_table(self) -> "pa.Table":
        """Return one row a policy: its fate, then each metric with its interval over such paths.

        Columns are ``policy``, ``rank``, ``status``, ``reason``, ``oracle``, ``knob``,
        ``p_keeps``, and of each metric ``ID``, ``ID_low`` and ``ID_high``, null where there is no
        value.
        """
        import pyarrow as pa

        columns: dict[str, pa.Array[Any]] = {
            "policy": pa.array([policy.label for policy in self.policies], pa.string()),
            "rank": pa.array([policy.rank for policy in self.policies], pa.int64()),
            "status": pa.array([policy.status for policy in self.policies], pa.string()),
            "reason": pa.array([policy.reason for policy in self.policies], pa.string()),
            "oracle": pa.array([policy.oracle for policy in self.policies], pa.bool_()),
            "knob": pa.array([knob_text(policy) or None for policy in self.policies], pa.string()),
            "p_keeps": pa.array([_p_keeps(policy) for policy in self.policies], pa.float64()),
        }
        for metric in METRICS:
            scores = [policy.metrics.get(metric.id) for policy in self.policies]
            values = [None if score is None else score.value for score in scores]
            spans = [None if score is None else score.such_paths for score in scores]
            columns[metric.id] = pa.array(values, pa.float64())
            for end, name in enumerate(("low", "high")):
                ends = [None if span is None else span[end] for span in spans]
                columns[f"{metric.id}_{name}"] = pa.array(ends, pa.float64())
        return pa.table(columns)

    def figure(self, name: str) -> Any:
        """Return a plotly figure: ``tradeoff``, error over work, or ``switches``, over error.

        Each policy is a line as its knob turns, with a point where it was set for the budget.

        Raises `InputError` for another name.
        """
        from ..report.notebook.figures import draw_figure

        return draw_figure(self, name)

    def _repr_html_(self) -> str:
        from ..report.notebook.ranking import ranking_html

        return ranking_html(self)

    @property
    def ok(self) -> tuple[PolicyResult, ...]:
        """Policies that were scored."""
        return tuple(policy for policy in self.policies if policy.status == "ok")

    @property
    def failed(self) -> tuple[PolicyResult, ...]:
        """Policies that broke their contract."""
        return tuple(policy for policy in self.policies if policy.status == "failed")


def _p_keeps(policy: PolicyResult) -> float | None:
    return None if policy.keeps_budget is None else policy.keeps_budget.probability


def read_comparison(path: Path) -> Comparison:
    """Read ``comparison.json``.

    Raises `InputError` if the file is missing or holds no such record.
    """
    advice = "give a folder that `lodbench compare --out` wrote, or run it again"
    with guarded(path, "a comparison", advice):
        return read_json(path, Comparison, SCHEMA, advice)
