"""The result of a comparison: records whose fields are the keys of ``comparison.json``."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from ...base.files.strict_json import read_json
from ...base.html_table import html_table
from ..metrics.metric import Better
from ..metrics.metric_registry import METRICS
from ..metrics.steps import Step

if TYPE_CHECKING:
    import pyarrow as pa

SCHEMA = "lodbench.compare/2"

SHOWN = (
    *("work_ms_p99", "over_budget_time_fraction", "lag_ms_mean"),
    *("visible_pops_per_s", "visible_error_px"),
)
"""Metrics that stand for budget, lag, flicker and quality in a notebook."""

Status = Literal["ok", "failed", "not-applicable"]


@dataclass(frozen=True, slots=True)
class Score:
    """A metric of one policy.

    Attributes
    ----------
    value : float or None
        None where the run cannot have the metric.
    low, high : float or None
        Ends of the interval over the draws of the cost model; None where there are none.
    """

    value: float | None
    low: float | None
    high: float | None
    unit: str
    better: Better


@dataclass(frozen=True, slots=True)
class PolicyResult:
    """What became of one policy.

    Attributes
    ----------
    label : str
        What the user wrote, which tells policies of one name apart.
    reason : str or None
        Why it failed or does not apply.
    frames : int
        Frames replayed, warm-up included.
    metrics : dict of str to Score
        By metric id; empty unless the status is ok.
    steps : tuple of Step
        Answers to the steps in visible load, after the warm-up.
    """

    name: str
    label: str
    params: dict[str, object]
    status: Status
    reason: str | None
    oracle: bool
    frames: int
    metrics: dict[str, Score]
    steps: tuple[Step, ...] = ()

    def value_of(self, metric: str) -> float | None:
        """Return the value of a metric, or None if there is none."""
        score = self.metrics.get(metric)
        return None if score is None else score.value


@dataclass(frozen=True, slots=True)
class ReplayConditions:
    """Under which conditions the replays ran, beside scene, trace and hardware."""

    display: str
    refresh_hz: float
    frames_in_flight: int
    width_px: int
    height_px: int
    fovy_deg: float
    crossfade_ms: float
    measurement_delay: int
    trace_s: float
    nodes: int
    hardware_source: str
    hardware_assumed: bool


@dataclass(frozen=True, slots=True)
class Intervals:
    """How intervals were made.

    Attributes
    ----------
    level : float
        Share of draws between low and high.
    draws : int
        Posterior draws of the cost model that were replayed; 0 if the profile has none, and then
        there are no intervals.
    """

    level: float
    draws: int


@dataclass(frozen=True, slots=True, repr=False)
class Comparison:
    """A comparison of policies, without any wall-clock time.

    Attributes
    ----------
    window_s : (start, end)
        The stretch of the path that metrics count, the same for every policy.
    visible_px : float
        Least error, and least change of it, that is seen.
    """

    scene: str
    trace: str
    hardware: str
    budget_ms: float
    seed: int
    window_s: tuple[float, float]
    visible_px: float
    conditions: ReplayConditions
    intervals: Intervals
    policies: tuple[PolicyResult, ...]
    schema: Literal["lodbench.compare/2"] = SCHEMA

    def __repr__(self) -> str:
        outcomes = ", ".join(f"{policy.label} {policy.status}" for policy in self.policies)
        return (
            f"<Comparison in {self.scene} on {self.trace}, {self.hardware}, "
            f"{self.budget_ms:.4g} ms: {outcomes}>"
        )

    def to_table(self) -> "pa.Table":
        """Return one row a policy: its fate, then each metric with the ends of its interval.

        Columns are ``policy``, ``status``, ``reason``, ``oracle``, ``frames``, and of each metric
        ``ID``, ``ID_low`` and ``ID_high``, null where there is no value.
        """
        import pyarrow as pa

        columns: dict[str, pa.Array[Any]] = {
            "policy": pa.array([policy.label for policy in self.policies], pa.string()),
            "status": pa.array([policy.status for policy in self.policies], pa.string()),
            "reason": pa.array([policy.reason for policy in self.policies], pa.string()),
            "oracle": pa.array([policy.oracle for policy in self.policies], pa.bool_()),
            "frames": pa.array([policy.frames for policy in self.policies], pa.int64()),
        }
        for metric in METRICS:
            scores = [policy.metrics.get(metric.id) for policy in self.policies]
            for suffix, part in (("", "value"), ("_low", "low"), ("_high", "high")):
                values = [None if score is None else getattr(score, part) for score in scores]
                columns[metric.id + suffix] = pa.array(values, pa.float64())
        return pa.table(columns)

    def _repr_html_(self) -> str:
        rows = [
            (policy.label, policy.reason or policy.status, *map(policy.value_of, SHOWN))
            for policy in self.policies
        ]
        caption = f"{self.scene}, {self.trace}, {self.hardware}, {self.budget_ms:.4g} ms"
        return html_table(caption, ("policy", "status", *SHOWN), rows)

    @property
    def ok(self) -> tuple[PolicyResult, ...]:
        """Policies that were scored."""
        return tuple(policy for policy in self.policies if policy.status == "ok")

    @property
    def failed(self) -> tuple[PolicyResult, ...]:
        """Policies that broke their contract."""
        return tuple(policy for policy in self.policies if policy.status == "failed")


def read_comparison(path: Path) -> Comparison:
    """Read ``comparison.json``.

    Raises `InputError` if the file is missing or holds no such record.
    """
    advice = "give a folder that `lodbench compare --out` wrote, or run it again"
    return read_json(path, Comparison, SCHEMA, advice)
