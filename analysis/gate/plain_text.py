"""A report in plain words, the same in a terminal, in a failed test and in an annotation."""

from collections.abc import Iterator, Sequence

from ..report.values import format_value
from .check_result import CheckReport
from .judgement import Change, Verdict, Worst

_WORDS = {"passes": "passes", "fails": "FAILS", "undecided": "undecided"}
_OF = {
    "this-path": " on these paths",
    "such-paths": " on such paths",
    "observed": " as observed",
    "": "",
}


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
    """Return a verdict in one line: what, how much, the limit, and the worst moment."""
    where = f"{verdict.policy} in {verdict.scene}"
    if verdict.paths:
        where += f" on {name_paths(verdict.paths)}"
    return f"{_WORDS[verdict.outcome]}: {where}: {explain(verdict)}"


def name_paths(paths: Sequence[str]) -> str:
    """Return the name of a path, or of the first and last of several and how many there are."""
    return paths[0] if len(paths) == 1 else f"{len(paths)} paths, {paths[0]} to {paths[-1]}"


def explain(verdict: Verdict) -> str:
    """Return what `describe` says after policy, scene and paths."""
    parts = [verdict.metric]
    if verdict.value is not None:
        parts[0] += f" {format_value(verdict.value)} {verdict.unit}"
        parts[0] += "" if verdict.bound is None else f" [{_bound(verdict)}]"
    if verdict.change is not None:
        parts.append(_change(verdict, verdict.change))
    if verdict.limit:
        parts.append(f"limit {verdict.limit}{_OF[verdict.population]}")
    if verdict.outcome == "fails" and verdict.p is not None:
        parts.append(f"p {'< .0001' if verdict.p < 1e-4 else format_value(verdict.p)}")
    text = ", ".join(parts)
    if verdict.reason is not None:
        text += f": {verdict.reason}"
    if verdict.outcome == "undecided" and verdict.needed_text:
        text += f"; {verdict.needed_text} would decide"
    return text if verdict.worst is None else f"{text}; {_worst(verdict.worst)}"


def _bound(verdict: Verdict) -> str:
    """Return where the mean ends, in the direction in which the limit is broken."""
    assert verdict.bound is not None
    return f"{'<' if verdict.limit.startswith('max') else '>'} {format_value(verdict.bound)}"


def _change(verdict: Verdict, change: Change) -> str:
    ends = "<" if verdict.limit.startswith("max_increase") else ">"
    return (
        f"{change.value:+.3g} [{ends} {change.bound:+.3g}] {change.unit} on a baseline of "
        f"{format_value(change.baseline)}"
    )


def _worst(worst: Worst) -> str:
    moment = worst.moment
    x, y, z = moment.camera_m
    grown = f", {moment.term} +{format_value(moment.grown_ms)} ms" if moment.term else ""
    return (
        f"worst {format_value(worst.value)} on {moment.path}, seed {worst.seed}: at "
        f"{moment.time_s:.2f} s {format_value(moment.work_ms)} ms{grown}, camera at "
        f"({x:.2f}, {y:.2f}, {z:.2f}) m"
    )


def _of(word: str) -> str:
    return {"passes": "passed", "fails": "failed"}.get(word, word)
