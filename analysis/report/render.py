"""Put a report together: a page that holds its data, charts and scripts."""

from html import escape
from pathlib import Path
from typing import Any

from ...sim.frame_log import FrameLog
from ..study.comparison import Comparison
from . import charts, tables, tradeoffs
from .page import chart_html, fill_page
from .palette import inks
from .terminal_table import describe_run

_PAGE = Path(__file__).with_name("page.html")


def render_report(comparison: Comparison, logs: dict[str, FrameLog]) -> str:
    """Return the HTML of a comparison; the same comparison gives the same bytes.

    Parameters
    ----------
    comparison : Comparison
    logs : dict of str to FrameLog
        By label, of every policy with status ok.
    """
    ink = inks(comparison)
    level = f"{comparison.intervals.level:.0%}"
    draws = comparison.intervals.draws
    scored = bool(comparison.ok)
    return fill_page(
        _PAGE,
        title=f"Which policy keeps {comparison.budget_ms:.4g} ms?",
        run=escape(describe_run(comparison)),
        assumed=_assumed(comparison),
        failures=tables.failures(comparison),
        verdicts=tables.verdicts(comparison, ink),
        level=level,
        headline=tables.headline(comparison, ink),
        time=chart_html("time", charts.time_chart(comparison, logs, ink) if scored else None),
        distribution=chart_html(
            "distribution", charts.distribution_chart(comparison, logs, ink) if scored else None
        ),
        steps=_steps(comparison, logs, ink),
        front=_front(comparison),
        pareto=chart_html("pareto", tradeoffs.pareto_chart(comparison, ink) if scored else None),
        drawn=f" over {draws} posterior draws of the cost model" if draws else "",
        duels=chart_html("duels", tradeoffs.duel_chart(comparison)),
        metrics=tables.metric_table(comparison, ink),
        provenance=tables.provenance(comparison),
    )


def _steps(comparison: Comparison, logs: dict[str, FrameLog], ink: dict[str, Any]) -> str:
    figure = charts.step_chart(comparison, logs, ink)
    if figure is None:
        return "<p>The visible load of this trace has no such step.</p>"
    drawn = charts.largest_steps(comparison)
    return chart_html("steps", figure) + tables.step_table(comparison, ink, drawn)


def _assumed(comparison: Comparison) -> str:
    if not comparison.conditions.hardware_assumed:
        return ""
    return (
        f'<p class="warn">The hardware profile {escape(comparison.hardware)} is assumed, not '
        "measured: the page compares policies, it does not predict a machine.</p>"
    )


def _front(comparison: Comparison) -> str:
    chances = comparison.pareto.probability
    if not chances:
        return ""
    listed = ", ".join(f"{escape(label)} {100 * p:.0f} %" for label, p in chances.items())
    return f"  Share of resamples in which a policy is on the front: {listed}."
