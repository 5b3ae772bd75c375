"""For how much of the time frames take how long: work time, and interval between displays."""

from typing import Any

from ...metrics.measured_frames import MeasuredFrames
from ..blocks import Chart
from ..results import Results, section
from ..series import tail
from ..style import BUDGET, add_line, panels, styled

_POINTS = 300
_TICKS_MS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]


@section("How slow the slow frames are")
def slow_frames(results: Results) -> tuple[Chart]:
    """On the first path, the share of time in frames that take so long or longer; both logarithmic.

    The 99th percentile is where a line crosses 1 %.
    """
    return (results.chart("distribution", _chart),)


def _chart(results: Results) -> Any:
    comparison = results.comparison
    titles = ["Work time", "Interval between displays"]
    figure = panels(1, 2, shared_yaxes=True, subplot_titles=titles)
    for policy in comparison.ok:
        run = MeasuredFrames(results.logs[policy.label], *comparison.window_s[0])
        for column, values in enumerate((run.work_ms, run.frame_ms), 1):
            x, share = tail(values, run.cost_weight_ms, _POINTS)
            ink, points = results.inks[policy.label], (x, 100.0 * share)
            add_line(figure, (1, column), points, policy, ink, first=column == 1, line_shape="vh")
    figure.add_vline(x=comparison.budget_ms, line=BUDGET)
    figure.update_yaxes(type="log", title_text="time in frames at least this slow, %", col=1)
    figure.update_yaxes(type="log", dtick=1)
    figure.update_xaxes(type="log", title_text="ms", tickvals=_TICKS_MS)
    return styled(figure, 350, comparison.ok)
