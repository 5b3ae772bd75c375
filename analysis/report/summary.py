"""What the table of the terminal and the page both say of a comparison."""

from dataclasses import dataclass

from ..study.comparison import Comparison
from ..study.comparison_parts import PolicyResult, Status, knob_text
from ..verdict.operating_point import SURE
from .names import readable
from .values import format_value


@dataclass(frozen=True, slots=True)
class MetricColumn:
    """A metric as a column of the short table."""

    metric: str
    header: str
    percent: bool = False

    def text(self, policy: PolicyResult) -> str:
        """Return a policy's value."""
        return format_value(policy.value_of(self.metric), percent=self.percent)


HEADLINE = (
    MetricColumn("visible_error_px", "visible\nerror\npx"),
    MetricColumn("visible_pops_per_s", "visible\npops\n/s"),
    MetricColumn("work_ms_mean", "work\nmean\nms"),
    MetricColumn("over_budget_time_fraction", "over\nbudget\n% time", percent=True),
    MetricColumn("lag_ms_mean", "lag\nmean\nms"),
)
"""Metrics of the order first, then what explains them."""

_BEHIND = {
    "missing_objects_mean": "holes",
    "visible_error_px": "error",
    "visible_pops_per_s": "pops",
    "lag_ms_mean": "lag",
    "work_ms_mean": "work",
}


def rank_text(policy: PolicyResult) -> str:
    """Return a policy's rank; what misses the budget has none."""
    if policy.oracle:
        return "oracle"
    return "misses" if policy.rank is None else str(policy.rank)


def behind_text(policy: PolicyResult) -> str:
    """Return a word for what put a policy behind the rank before; empty of what has none."""
    return _BEHIND.get(policy.behind_by or "", "")


def knob_words(policy: PolicyResult) -> str:
    """Return how a policy's knob was set, and whether for this budget."""
    if policy.knob is None:
        return ""
    return knob_text(policy) + ("" if policy.knob.tuned else " (as given)")


def keeps_text(policy: PolicyResult) -> str:
    """Return the probability of keeping another path, and how many were kept."""
    keeps = policy.keeps_budget
    if keeps is None:
        return ""
    kept = f"{keeps.kept}/{keeps.paths}"
    probability = keeps.probability
    if probability is None:
        return kept
    shown = round(probability, 2)
    if probability < SURE <= shown:  # rounded up, what misses would seem to pass
        shown -= 0.01
    return f"{shown:.2f} {kept}"


def shown_policies(comparison: Comparison) -> tuple[PolicyResult, ...]:
    """Return the scored policies that have a row: of those that did the same, one."""
    return tuple(policy for policy in comparison.ok if policy.same_as is None)


def folded(comparison: Comparison) -> list[str]:
    """Return a sentence for each policy that did the same as another."""
    return [
        f"{policy.label} did the same as {policy.same_as} in every run"
        for policy in comparison.ok
        if policy.same_as is not None
    ]


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


def words_of(comparison: Comparison, text: str) -> str:
    """Return a text about a comparison, with names cut that are too long to read."""
    labels = (policy.label for policy in comparison.policies)
    return readable(text, (*labels, comparison.scene, comparison.hardware, *comparison.paths))


def describe_run(comparison: Comparison) -> str:
    """Return in one line what was replayed."""
    c = comparison.conditions
    hardware = comparison.hardware
    if c.hardware_assumed and "assumed" not in hardware:
        hardware += " (assumed)"
    parts = (
        f"{comparison.scene}, {c.nodes:,} nodes",
        describe_paths(comparison),
        hardware,
        f"budget {comparison.budget_ms:.4g} ms",
        c.display if c.display in {"immediate", "vrr"} else f"{c.display} {c.refresh_hz:g} Hz",
        *(() if c.pacing == "none" else (f"pacing {c.pacing}",)),  # it decides the lag
        f"seed {comparison.seed}",
    )
    return " · ".join(parts)


def describe_paths(comparison: Comparison) -> str:
    """Return how many paths there were, and what of each counts."""
    first = comparison.paths[0]
    low, high = comparison.window_s[0]
    alike = len(set(comparison.window_s)) == 1
    window = f"{low:g} to {high:g} s" if alike else "each from its warm-up to its end"
    if len(comparison.paths) == 1:
        return f"{first}, {window}"
    return f"{len(comparison.paths)} paths such as {first}, {window}"
