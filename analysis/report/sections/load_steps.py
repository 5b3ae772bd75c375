"""How policies answer a step in load: a chart about each step, and a table of the answers."""

from collections.abc import Iterator

from ...metrics.measured_frames import MeasuredFrames
from ...metrics.steps import APART_NS, Step
from ...study.comparison import Comparison
from ...study.comparison_parts import PolicyResult
from ..blocks import Cell, Paragraph, Table
from ..plots import Axis, Line, Plot, Plots, Rule, line_of
from ..results import Results, section
from ..series import envelope
from ..values import ABSENT, counted, format_value

_BUCKETS = 150
_BEFORE_S, _AFTER_S = 0.25, 1.5
_MOST_STEPS = 6
_HIGHEST = 4.0
"""Work over budget beyond which lines leave the plot."""
_BOUND = ">"
"""Stands before a value that is a lower bound."""


def _in_short(results: Results) -> str:
    """Return whose work overshoots least and most, of who met most steps."""
    most = max((len(policy.steps) for policy in results.drawn), default=0)
    if not most:
        return ""
    means = {
        policy.label: sum(step.overshoot_ratio for step in policy.steps) / most
        for policy in results.drawn
        if len(policy.steps) == most
    }
    least, worst = min(means, key=means.__getitem__), max(means, key=means.__getitem__)
    text = f"After {counted(most, 'step')} in load the work of {least} rises to "
    text += f"{format_value(means[least])} × the budget{' on average' * (most > 1)}"
    if worst == least:
        return f"{text}."
    return f"{text}, the least; that of {worst} to {format_value(means[worst])} ×, the most."


@section("After a step in load", takeaway=_in_short)
def load_steps(results: Results) -> tuple[Paragraph] | tuple[Plots, Table]:
    """On the first path, work time over the budget, about each of the largest steps: up to six.

    A step is a rise of what is visible, priced at full detail, by a quarter or more within 100 ms
    to above the budget.  Overshoot is the largest work time until the budget has been kept for
    250 ms, over the budget; settling is the time until it is kept.  “>” marks a policy that had not
    settled by the next step, after 5 s, or at the end.
    """
    steps = _largest_steps(results.comparison)
    if not steps:
        return (Paragraph("The visible load of the first path has no such step."),)
    return Plots(list(_plots(results, steps)), beside=True), _table(results, steps)


def _largest_steps(comparison: Comparison) -> list[Step]:
    """Return the steps to draw, in order of time: the largest rises that some policy met."""
    runs = [policy.steps for policy in comparison.ok if policy.steps]
    steps = max(runs, key=len, default=())
    rise = sorted(steps, key=lambda step: step.load_before_ms - step.load_after_ms)
    return sorted(rise[:_MOST_STEPS], key=lambda step: step.time_ms)


def _plots(results: Results, steps: list[Step]) -> Iterator[Plot]:
    """Return work over budget about each step, all over the same axes."""
    comparison = results.comparison
    runs = {p.label: MeasuredFrames(results.logs[p.label]) for p in results.drawn}
    overshoots = [step.overshoot_ratio or 0.0 for p in results.drawn for step in p.steps]
    x = Axis("s since the step", -_BEFORE_S, _AFTER_S)
    y = Axis("work / budget", 0.0, 1.1 * min(max(overshoots, default=1.0) + 0.2, _HIGHEST))
    for at, step in enumerate(steps):
        lines: list[Line] = []
        for label, run in runs.items():
            since_s = run.time_s - step.time_ms * 1e-3
            near = (since_s >= -_BEFORE_S) & (since_s <= _AFTER_S)
            points = since_s[near], run.work_ms[near] / comparison.budget_ms
            lines.append(line_of(results.inks[label], (x, y), envelope(*points, _BUCKETS)))
        load = f"load {step.load_before_ms:.1f} → {step.load_after_ms:.1f} ms"
        rules = [Rule(False, round(100.0 * y.at(1.0), 2), "")]
        title = f"At {step.time_ms * 1e-3:.1f} s: {load}"
        yield Plot(f"step-{at}", title, x, y, lines, rules=rules, height_px=190)


def _table(results: Results, drawn: list[Step]) -> Table:
    """Return overshoot and settling of each policy after each step, and on average."""
    heads = [f"{step.time_ms * 1e-3:.1f} s" for step in drawn]
    rows = [
        (results.name_of(policy), *(_answer(policy, step) for step in drawn), _mean(policy))
        for policy in results.drawn
    ]
    heads = ["overshoot, settling", *heads, "mean of all"]
    return Table(heads, rows, name="steps")


def _answer(policy: PolicyResult, drawn: Step) -> Cell:
    """Return how a policy answered a step.

    Policies sample the trace at different times; a step of one is that of another if they are
    closer than `APART_NS`.
    """
    step = min(policy.steps, key=lambda met: abs(met.time_ms - drawn.time_ms), default=None)
    if step is None or abs(step.time_ms - drawn.time_ms) * 1e6 >= APART_NS:
        return Cell(ABSENT)
    return _cell(step.overshoot_ratio, step.settle_ms, bound=not step.settled)


def _mean(policy: PolicyResult) -> Cell:
    """Return the mean answer to the steps of the first path."""
    if not policy.steps:
        return Cell(ABSENT)
    count = len(policy.steps)
    overshoot = sum(step.overshoot_ratio for step in policy.steps) / count
    settle_ms = sum(step.settle_ms for step in policy.steps) / count
    return _cell(overshoot, settle_ms, bound=not all(step.settled for step in policy.steps))


def _cell(overshoot: float | None, settle_ms: float | None, *, bound: bool) -> Cell:
    return Cell(
        f"{format_value(overshoot)} ×", f"{_BOUND * bound}{format_value(settle_ms)} ms",
        value=overshoot,
    )  # fmt: skip
