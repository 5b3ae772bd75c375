"""What a policy gives for what: picture error and switches over work, as its knob turns."""

from typing import Any

from ...study.comparison import Comparison
from ...study.comparison_parts import PolicyResult
from ..blocks import Chart, Table
from ..results import Results, section
from ..style import BUDGET, panels, styled
from ..values import format_value


@section("What each policy gives at every budget")
def tradeoffs(results: Results) -> tuple[Chart, Table] | tuple[Chart]:
    """Each line is a policy as its knob turns; its point is where it was set for this budget.

    Lower is better; the dashed line is the budget.  Work is the time that budgets judge, the mean
    over paths.  A policy without a knob is a point.
    """
    chart = results.chart("tradeoff", _chart)
    robustness = results.comparison.robustness
    if robustness is None:
        return (chart,)
    rows = [
        (
            f"{at.refresh_hz:g} Hz, {at.budget_ms:.4g} ms",
            ", ".join(at.first) or "nobody",
            ", ".join(at.misses) or "–",
        )
        for at in robustness.budgets
    ]
    rows += [
        (f"with {item.cost}", ", ".join(item.first) or "nobody", ", ".join(item.misses) or "–")
        for item in robustness.costs
    ]
    heads = ("budget, read off the curves", "first rank", "does not reach it")
    return chart, Table(heads, rows)


def _chart(results: Results) -> Any:
    comparison = results.comparison
    titles = ["Visible error, px", "Visible pops per second"]
    figure = panels(1, 2, subplot_titles=titles, horizontal_spacing=0.07)
    for policy in comparison.ok:
        _draw(figure, results, comparison, policy)
    figure.add_vline(x=comparison.budget_ms, line=BUDGET)
    quantile = format_value(1.0 - comparison.miss, percent=True)
    figure.update_xaxes(type="log", title_text=f"work, ms at {quantile} % of the time")
    figure.update_yaxes(rangemode="tozero")
    return styled(figure, 430, comparison.ok)


def _draw(figure: Any, results: Results, comparison: Comparison, policy: PolicyResult) -> None:
    ink, keeps = results.inks[policy.label], policy.keeps_budget
    curve = comparison.curve.get(policy.label)
    if curve is not None:
        for column, values in enumerate((curve.visible_error_px, curve.pops_per_s), 1):
            figure.add_scatter(
                x=curve.work_ms, y=values, row=1, col=column, mode="lines", showlegend=False,
                legendgroup=policy.label, name=policy.label,
                line={"color": ink.color, "dash": ink.dash, "width": 1.4},
            )  # fmt: skip
    if keeps is None:
        return
    for column, metric in enumerate(("visible_error_px", "visible_pops_per_s"), 1):
        figure.add_scatter(
            x=[keeps.work_ms], y=[policy.value_of(metric)], row=1, col=column, mode="markers",
            marker={"color": ink.color, "size": 10, "symbol": ink.symbol},
            name=policy.label, legendgroup=policy.label, showlegend=column == 1,
        )  # fmt: skip
