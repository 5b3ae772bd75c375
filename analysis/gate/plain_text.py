"""A report in plain words, the same in a terminal, in a failed test and in an annotation."""

from collections.abc import Iterator

from ..report.values import format_value
from .check_result import CheckReport
from .judgement import Change, Verdict

_WORDS = {"passes": "passes", "fails": "FAILS", "undecided": "undecided"}


def lines(report: CheckReport) -> Iterator[str]:
    """Yield one line a verdict, what was never applied, and the sum of it."""
    for verdict in report.verdicts:
        yield describe(verdict)
    for rule in report.unused:
        yield f"limits for {rule}: nothing that ran matches"
    counts = ", ".join(f"{report.count(word)} {_of(word)}" for word in _WORDS)
    strict = " (strict: undecided is failure)" if report.strict else ""
    yield f"{'passed' if report.passed else 'failed'}: {counts}{strict}"


def describe_failures(report: CheckReport) -> str:
    """Return the lines of what failed the check."""
    wrong = [describe(verdict) for verdict in report.verdicts if report.is_failure(verdict)]
    if report.strict:
        wrong += [f"limits for {rule}: nothing that ran matches" for rule in report.unused]
    return "\n".join(wrong)


def describe(verdict: Verdict) -> str:
    """Return a verdict in one line: what, how much, the limit, and the worst frame."""
    where = f"{verdict.policy} in {verdict.scene} on {verdict.trace}"
    return f"{_WORDS[verdict.outcome]}: {where}: {explain(verdict)}"


def explain(verdict: Verdict) -> str:
    """Return what `describe` says after policy, scene and trace."""
    parts = [verdict.metric]
    if verdict.value is not None:
        parts[0] += (
            f" {format_value(verdict.value)} {verdict.unit}{_span(verdict.low, verdict.high)}"
        )
    if verdict.change is not None:
        parts.append(_change(verdict.change))
    if verdict.limit:
        parts.append(f"limit {verdict.limit}")
    text = ", ".join(parts)
    if verdict.reason is not None:
        text += f": {verdict.reason}"
    worst = verdict.worst
    if worst is None or verdict.outcome == "passes":
        return text
    x, y, z = worst.camera_m
    return (
        f"{text}; worst frame {worst.frame} of seed {worst.seed} at {worst.time_s:.2f} s with "
        f"{format_value(worst.value)}, camera at ({x:.2f}, {y:.2f}, {z:.2f}) m"
    )


def _span(low: float | None, high: float | None) -> str:
    return "" if low is None else f" [{format_value(low)}, {format_value(high)}]"


def _change(change: Change) -> str:
    value, low, high = (f"{x:+.3g}" for x in (change.value, change.low, change.high))
    return f"{value} [{low}, {high}] {change.unit} on a baseline of {format_value(change.baseline)}"


def _of(word: str) -> str:
    return {"passes": "passed", "fails": "failed"}.get(word, word)
