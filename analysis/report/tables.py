"""Tables of a report, as HTML."""

from collections.abc import Iterable, Iterator
from html import escape

from ...base.version import __version__
from ..metrics.metric_registry import METRICS, find_metric
from ..metrics.steps import APART_NS, Step
from ..study.comparison import Comparison, PolicyResult, Score
from .palette import Ink
from .terminal_table import ABSENT, HEADLINE, best_labels, format_value, unscored

_LEADERS = (
    ("Budget kept best", "over_budget_fraction"),
    ("Steadiest frames", "frame_ms_sd"),
    ("Least lag", "lag_ms_mean"),
    ("Least flicker", "toggles_per_frame"),
    ("Least error", "sse_px_p95"),
)
_MOST_NAMED = 3
"""Policies of equal score that are named as leaders; the table below marks them all."""


def verdicts(comparison: Comparison, ink: dict[str, Ink]) -> str:
    """Return who leads in each group, and with what value."""
    return "".join(_verdict(comparison, ink, *leader) for leader in _LEADERS)


def _verdict(comparison: Comparison, ink: dict[str, Ink], title: str, metric: str) -> str:
    best = [policy for policy in comparison.ok if policy.label in best_labels(comparison, metric)]
    names = "<br>".join(_chip(policy, ink) for policy in best[:_MOST_NAMED]) or "no difference"
    if len(best) > _MOST_NAMED:
        names += f"<br>and {len(best) - _MOST_NAMED} more"
    detail = ""
    if best:
        score = best[0].metrics[metric]
        detail = f"{_amount(score)} {_span(score)}"
    return (
        f'<div class="tile"><h3>{title}</h3><p class="name">{names}</p>'
        f'<p class="dim">{escape(metric)} {detail}</p></div>'
    )


def headline(comparison: Comparison, ink: dict[str, Ink]) -> str:
    """Return the table of the terminal, with the interval below each value."""
    best = {column.metric: best_labels(comparison, column.metric) for column in HEADLINE}
    head = "".join(
        f'<th title="{escape(find_metric(column.metric).definition)}">'
        f"{escape(' '.join(column.header.split()).replace('- ', ''))}</th>"
        for column in HEADLINE
    )
    rows: list[str] = []
    for policy in comparison.ok:
        cells = [f"<th>{_chip(policy, ink)}<br>{_marks(policy, comparison)}</th>"]
        for column in HEADLINE:
            score = policy.metrics[column.metric]
            text = format_value(score.value, percent=column.percent)
            if column.metric == "settle_ms" and not all(step.settled for step in policy.steps):
                text = f"&gt; {text}"
            winner = ' class="best"' if policy.label in best[column.metric] else ""
            cells.append(f"<td{winner}>{text}{_interval(score, percent=column.percent)}</td>")
        rows.append(f"<tr>{''.join(cells)}</tr>")
    return html_table(f"<th>policy</th>{head}", rows)


def failures(comparison: Comparison) -> str:
    """Return the policies that have no scores, and why."""
    items = [
        f"<li><b class={status}>{escape(', '.join(labels))}</b> {escape(status)}: "
        f"{escape(reason)}</li>"
        for status, labels, reason in unscored(comparison)
    ]
    return f'<ul class="unscored">{"".join(items)}</ul>' if items else ""


def step_table(comparison: Comparison, ink: dict[str, Ink], drawn: list[Step]) -> str:
    """Return overshoot and settling of each policy after each step that is drawn, and on average.

    Policies sample the trace at different times; a step of one is that of another if they are
    closer than `APART_NS`.
    """
    heads = "".join(f"<th>{step.time_ms * 1e-3:.1f} s</th>" for step in drawn)
    rows: list[str] = []
    for policy in comparison.ok:
        cells = [f"<th>{_chip(policy, ink)}</th>"]
        for wanted in drawn:
            step = min(
                policy.steps, key=lambda met: abs(met.time_ms - wanted.time_ms), default=None
            )
            met = step is not None and abs(step.time_ms - wanted.time_ms) * 1e6 < APART_NS
            cells.append(f"<td>{_answer(step) if step is not None and met else ABSENT}</td>")
        overshoot, settle = policy.metrics["overshoot_ratio"], policy.metrics["settle_ms"]
        bound = "" if all(step.settled for step in policy.steps) else "&gt; "
        cells.append(
            f"<td>{format_value(overshoot.value)} ×"
            f"<small>{bound}{format_value(settle.value)} ms</small></td>"
        )
        rows.append(f"<tr>{''.join(cells)}</tr>")
    return html_table(f"<th>overshoot, settling</th>{heads}<th>mean of all</th>", rows)


def _answer(step: Step) -> str:
    bound = "" if step.settled else "&gt; "
    settle = f"{bound}{format_value(step.settle_ms)} ms"
    return f"{format_value(step.overshoot_ratio)} ×<small>{settle}</small>"


def metric_table(comparison: Comparison, ink: dict[str, Ink]) -> str:
    """Return every metric with its interval, definition and source."""
    head = "".join(f"<th>{_chip(policy, ink)}</th>" for policy in comparison.ok)
    rows: list[str] = []
    group = ""
    for metric in METRICS:
        if metric.group != group:
            group = metric.group
            rows.append(f'<tr class="group"><th colspan="99">{group}</th></tr>')
        best = best_labels(comparison, metric.id)
        cells: list[str] = []
        for policy in comparison.ok:
            score = policy.metrics[metric.id]
            winner = ' class="best"' if policy.label in best else ""
            cells.append(f"<td{winner}>{format_value(score.value)}{_interval(score)}</td>")
        explained = f"{metric.definition}  Source: {metric.source}"
        rows.append(
            f'<tr><th title="{escape(explained)}"><code>{metric.id}</code></th>'
            f"<td>{escape(metric.unit)}</td>{''.join(cells)}</tr>"
            f'<tr class="text"><td colspan="99">{escape(metric.definition)} '
            f"<i>{metric.better} is better.  Source: {escape(metric.source)}</i></td></tr>"
        )
    return html_table(f"<th>metric</th><th>unit</th>{head}", rows)


def provenance(comparison: Comparison) -> str:
    """Return where every number of the page comes from."""
    return facts_table(_facts(comparison))


def facts_table(facts: Iterable[tuple[str, str]]) -> str:
    """Return pairs of a name and a text as a table."""
    rows = "".join(
        f"<tr><th>{escape(key)}</th><td>{escape(value)}</td></tr>" for key, value in facts
    )
    return f'<table class="facts"><tbody>{rows}</tbody></table>'


def _facts(comparison: Comparison) -> Iterator[tuple[str, str]]:
    c, i = comparison.conditions, comparison.intervals
    measured = "assumed, not measured" if c.hardware_assumed else "measured or published"
    yield "scene", f"{comparison.scene}, {c.nodes:,} nodes"
    yield "trace", f"{comparison.trace}, {c.trace_s:.2f} s"
    yield "hardware", f"{comparison.hardware}: {measured}; {c.hardware_source}"
    yield "display", f"{c.display}, {c.refresh_hz:g} Hz, {c.width_px} × {c.height_px} px"
    yield "pipeline", f"{c.frames_in_flight} frames in flight, fovy {c.fovy_deg:g}°"
    yield "cross-fade", f"{c.crossfade_ms:g} ms"
    yield "timers", f"read {c.measurement_delay} frames after completion"
    yield "budget", f"{comparison.budget_ms:.6g} ms"
    yield "seed", str(comparison.seed)
    yield "warm-up", f"the first {comparison.warmup} frames of each replay are not counted"
    draws = f", pooled over {i.draws} posterior draws of the cost model" if i.draws else ""
    sampled = f"{i.level:.0%} of {i.resamples} resamples of blocks of 1/{i.blocks} of the run"
    yield "intervals", f"{sampled}{draws}; same blocks, draws and noise for every policy"
    yield "made by", f"lodbench {__version__}"


def html_table(head: str, rows: Iterable[str]) -> str:
    """Return a table that scrolls where it is too wide."""
    return (
        f'<div class="scroll"><table><thead><tr>{head}</tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table></div>"
    )


def _chip(policy: PolicyResult, ink: dict[str, Ink]) -> str:
    drawn = ink[policy.label]
    chip = f'<span class="chip {drawn.symbol}" style="color:{drawn.color}"></span>'
    return f"{chip}{escape(policy.label)}"


def _marks(policy: PolicyResult, comparison: Comparison) -> str:
    oracle = ' <span class="tag">oracle</span>' if policy.oracle else ""
    front = ' <span class="tag">front</span>' if policy.label in comparison.pareto.front else ""
    return oracle + front


def _amount(score: Score) -> str:
    percent = score.unit == "fraction"
    unit = "%" if percent else escape(score.unit)
    return f"{format_value(score.value, percent=percent)} {unit}"


def _span(score: Score) -> str:
    return _interval(score, percent=score.unit == "fraction", tag="span")


def _interval(score: Score, *, percent: bool = False, tag: str = "small") -> str:
    if score.low is None or score.low == score.high:
        return ""
    low, high = (format_value(end, percent=percent) for end in (score.low, score.high))
    return f"<{tag}>{low} to {high}</{tag}>"
