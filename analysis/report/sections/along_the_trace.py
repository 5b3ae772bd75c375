"""Charts over the time of the first path: work, lag, switches and error."""

from typing import Any

import numpy as np

from ...metrics.measured_frames import MeasuredFrames
from ..blocks import Chart
from ..results import Results, section
from ..series import envelope
from ..style import BUDGET, add_line, panels, styled

_BUCKETS = 700
_BIN_S = 0.5
_TITLES = (
    "Work time, ms",
    "Lag, ms",
    f"Visible pops per second, over {_BIN_S:g} s",
    "Projected error, 95th percentile of nodes, px",
)


@section("Along the first path")
def along_the_trace(results: Results) -> tuple[Chart]:
    """Drag to zoom all four; click a name to hide a policy.

    The dashed line is the budget.  Where frames are too many to draw, minima and maxima are kept.
    An axis ends at three times what the middle policy reaches: double-click twice to see all.
    """
    return (results.chart("time", _chart),)


def _chart(results: Results) -> Any:
    comparison = results.comparison
    figure = panels(
        4, 1, shared_xaxes=True, vertical_spacing=0.055, subplot_titles=_TITLES,
        row_heights=[0.34, 0.22, 0.22, 0.22],
    )  # fmt: skip
    tops: list[list[float]] = [[], [], [], []]
    for policy in comparison.ok:
        run = MeasuredFrames(results.logs[policy.label])
        time_s = run.time_s
        edges = np.arange(0.0, time_s[-1] + _BIN_S, _BIN_S)
        rows = (
            envelope(time_s, run.work_ms, _BUCKETS),
            envelope(time_s, run.lag_ms, _BUCKETS),
            (
                0.5 * (edges[1:] + edges[:-1]),
                np.histogram(time_s, edges, weights=run["visible_pops"])[0] / _BIN_S,
            ),
            envelope(time_s, run["sse_px_p95"], _BUCKETS),
        )
        for row, points in enumerate(rows, 1):
            ink = results.inks[policy.label]
            add_line(figure, (row, 1), points, policy, ink, first=row == 1)
            tops[row - 1].append(float(np.nanquantile(points[1], 0.99)))
    tops[0].append(comparison.budget_ms)
    for row, top in enumerate(tops, 1):
        figure.update_yaxes(range=(0.0, _top(top)), row=row, col=1)
    figure.add_hline(y=comparison.budget_ms, row=1, col=1, line=BUDGET)
    figure.update_xaxes(title_text="time of the path, s", row=4, col=1)
    return styled(figure, 860, comparison.ok)


def _top(tops: list[float]) -> float:
    """Return the end of an axis: all that is reached, or thrice what the middle policy reaches."""
    middle = float(np.median(tops))
    highest = max(tops)
    return 1.1 * (min(highest, 3.0 * middle) if middle > 0.0 else max(highest, 1e-6))
