"""What the table of the terminal and the page both say of a comparison."""

from dataclasses import dataclass

from ..study.comparison import Comparison, PolicyResult, Status
from .values import format_value

BOUND = ">"
"""Stands before a value that is a lower bound."""


@dataclass(frozen=True, slots=True)
class MetricColumn:
    """A metric as a column of the short table."""

    metric: str
    header: str
    percent: bool = False

    def text(self, policy: PolicyResult) -> str:
        """Return a policy's value, marked where it is a lower bound."""
        text = format_value(policy.metrics[self.metric].value, percent=self.percent)
        return BOUND + text if self.metric == "settle_ms" and not settled(policy) else text


HEADLINE = (
    MetricColumn("work_ms_p99", "work\np99\nms"),
    MetricColumn("frame_ms_sd", "frame\nsd\nms"),
    MetricColumn("over_budget_time_fraction", "over\nbudget\n%", percent=True),
    MetricColumn("settle_ms", "settle\n\nms"),
    MetricColumn("overshoot_ratio", "over-\nshoot\n×"),
    MetricColumn("lag_ms_mean", "lag\nmean\nms"),
    MetricColumn("visible_pops_per_s", "seen\npops\n/s"),
    MetricColumn("toggles_per_s", "toggles\n/s"),
    MetricColumn("visible_error_px", "seen\nerror\npx"),
    MetricColumn("sse_px_p95", "error\np95\npx"),
    MetricColumn("benefit_ratio", "bene-\nfit\n%", percent=True),
)


def settled(policy: PolicyResult) -> bool:
    """Whether a policy settled after every step, so that its mean is no lower bound."""
    return all(step.settled for step in policy.steps)


def best_labels(comparison: Comparison, metric: str) -> set[str]:
    """Return the policies with the best value; none where all are equal, and never an oracle."""
    scores = {policy.label: policy.metrics[metric] for policy in comparison.ok if not policy.oracle}
    values = {label: item.value for label, item in scores.items() if item.value is not None}
    if len(set(values.values())) < 2:
        return set()
    pick = min if next(iter(scores.values())).better == "lower" else max
    best = pick(values.values())
    return {label for label, value in values.items() if value == best}


def unscored(comparison: Comparison) -> list[tuple[Status, str]]:
    """Return status and sentence of what has no scores, one entry for each reason."""
    groups: dict[tuple[Status, str], list[str]] = {}
    for policy in comparison.policies:
        if policy.status != "ok":
            groups.setdefault((policy.status, policy.reason or ""), []).append(policy.label)
    return [
        (status, f"{status}: {', '.join(labels)}: {reason}")
        for (status, reason), labels in groups.items()
    ]


def describe_run(comparison: Comparison) -> str:
    """Return in one line what was replayed."""
    c = comparison.conditions
    hardware = comparison.hardware
    if c.hardware_assumed and "assumed" not in hardware:
        hardware += " (assumed)"
    parts = (
        f"{comparison.scene}, {c.nodes:,} nodes",
        f"{comparison.trace}, {c.trace_s:.1f} s{_frames(comparison)}",
        hardware,
        f"budget {comparison.budget_ms:.4g} ms",
        c.display if c.display in {"immediate", "vrr"} else f"{c.display} {c.refresh_hz:g} Hz",
        f"seed {comparison.seed}",
    )
    return " · ".join(parts)


def _frames(comparison: Comparison) -> str:
    counts = {policy.frames for policy in comparison.ok}
    if not counts:
        return ""
    return f", {'up to ' if len(counts) > 1 else ''}{max(counts):,} frames"
