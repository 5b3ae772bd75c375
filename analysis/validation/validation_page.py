"""The page of a validation: tables, charts, and where the numbers come from."""

from collections.abc import Iterable, Iterator, Mapping
from html import escape
from pathlib import Path

from ...base.version import __version__
from ..metrics.metric_registry import METRICS
from ..report.page import chart_html, fill_page
from ..report.tables import facts_table, html_table
from ..report.terminal_table import format_value
from .validate import Pair
from .validation_charts import agreement_chart, series_chart
from .validation_result import Errors, Validation
from .validation_table import COMPARED, RANKED, error_text, error_word, rank_text

_PAGE = Path(__file__).with_name("validation_page.html")


def render_validation(validation: Validation, pairs: Mapping[str, Pair]) -> str:
    """Return the HTML of a validation."""
    log = validation.log
    run = (
        f"{validation.scene} along {validation.trace}, {validation.trace_s:.1f} s, drawn on "
        f"{log.get('renderer', 'a device')} at {log.get('resolution', 'some size')} and simulated "
        f"with the profile {validation.hardware}; budget {validation.budget_ms:.4g} ms"
    )
    return fill_page(
        _PAGE,
        title="Does the simulator agree with the machine?",
        run=escape(run),
        errors=_error_table(validation),
        series=chart_html("series", series_chart(validation, pairs)),
        level=f"{validation.level:.0%}",
        agreement=chart_html("agreement", agreement_chart(validation)),
        ranks=_rank_table(validation),
        metrics=_metric_table(validation),
        provenance=facts_table(_facts(validation)),
    )


def _error_table(validation: Validation) -> str:
    rows = [_error_row(policy.label, policy.errors) for policy in validation.policies]
    rows.append(_error_row("all policies", validation.all_policies))
    return html_table("<th>policy</th>" + _heads(title for _, title in COMPARED), rows)


def _error_row(label: str, errors: Errors) -> str:
    cells: list[str] = []
    for name, _ in COMPARED:
        found = error_word(errors, name)
        span = "" if found is None else f"<small>{found.p05_pct:.1f} to {found.p95_pct:.1f}</small>"
        cells.append(f"<td>{error_text(found)}{span}</td>")
    return f"<tr><th>{escape(label)}</th>{''.join(cells)}</tr>"


def _rank_table(validation: Validation) -> str:
    rows: list[str] = []
    for name in RANKED:
        rank = validation.ranks.get(name)
        simulated = rank_text(None if rank is None else rank.simulated)
        again = rank_text(None if rank is None else rank.again)
        rows.append(f"<tr><th><code>{name}</code></th><td>{simulated}</td><td>{again}</td></tr>")
    heads = _heads(("simulated and measured", "measured twice"))
    return html_table(f"<th>Kendall's τ</th>{heads}", rows)


def _metric_table(validation: Validation) -> str:
    rows: list[str] = []
    for metric in METRICS:
        cells: list[str] = []
        for policy in validation.policies:
            item = policy.metrics[metric.id]
            mark = "" if item.inside is not True else ' class="best"'
            span = "" if item.low is None else f", {format_value(item.low)} to "
            span += "" if item.high is None else format_value(item.high)
            cells.append(
                f"<td{mark}>{format_value(item.measured)}"
                f"<small>{format_value(item.simulated)}{span}</small></td>"
            )
        rank = validation.ranks.get(metric.id)
        cells.append(f"<td>{rank_text(None if rank is None else rank.simulated)}</td>")
        rows.append(
            f'<tr><th title="{escape(metric.definition)}"><code>{metric.id}</code></th>'
            f"<td>{escape(metric.unit)}</td>{''.join(cells)}</tr>"
        )
    note = (
        '<p class="dim">Measured, with the simulated value and its interval below; green where the '
        "measured value is inside.</p>"
    )
    heads = _heads(policy.label for policy in validation.policies)
    return note + html_table(f"<th>metric</th><th>unit</th>{heads}<th>τ</th>", rows)


def _facts(validation: Validation) -> Iterator[tuple[str, str]]:
    yield "profile", f"{validation.hardware}: {validation.hardware_source}"
    yield "calibrated on", ", ".join(validation.measured_on) or "not said"
    yield from validation.log.items()
    yield "warm-up", f"the first {validation.warmup} frames of each replay are not counted"
    yield "draws", f"{validation.draws} posterior draws of the cost model"
    yield "made by", f"lodbench {__version__}"


def _heads(titles: Iterable[str]) -> str:
    return "".join(f"<th>{escape(title)}</th>" for title in titles)
