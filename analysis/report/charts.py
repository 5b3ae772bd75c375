"""Charts of a report: over time, of distributions, and after steps."""

from typing import Any

import numpy as np

from ...sim.frame_log import FrameLog
from ..metrics.measured_frames import Run
from ..metrics.steps import Step
from ..study.comparison import Comparison
from .palette import Ink
from .series import bin_means, envelope, tail
from .style import BUDGET, line_of, shortened, styled

_BUCKETS = 700
_BIN_S = 0.5
_BEFORE_S, _AFTER_S = 0.25, 1.5
_MOST_STEPS = 6
_TICKS_MS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000]


def time_chart(comparison: Comparison, logs: dict[str, FrameLog], ink: dict[str, Ink]) -> Any:
    """Return work, lag, switches and error over the time of the trace, below one another."""
    from plotly.subplots import make_subplots

    titles = [
        "Work time, ms",
        "Lag, ms",
        f"Switches of level per frame, means of {_BIN_S:g} s",
        "Projected error, 95th percentile of nodes, px",
    ]
    figure: Any = make_subplots(
        rows=4, cols=1, shared_xaxes=True, vertical_spacing=0.055, subplot_titles=titles,
        row_heights=[0.34, 0.22, 0.22, 0.22],
    )  # fmt: skip
    tops: list[list[float]] = [[], [], [], []]
    for policy in comparison.ok:
        run = Run(logs[policy.label])
        time_s = run.time_s
        edges = np.arange(0.0, time_s[-1] + _BIN_S, _BIN_S)
        rows = (
            envelope(time_s, run.work_ms, _BUCKETS),
            envelope(time_s, run.lag_ms, _BUCKETS),
            (0.5 * (edges[1:] + edges[:-1]), bin_means(time_s, run["toggles"], edges)),
            envelope(time_s, run["sse_px_p95"], _BUCKETS),
        )
        for row, (x, y) in enumerate(rows, 1):
            figure.add_scatter(
                x=shortened(x),
                y=shortened(y),
                row=row,
                col=1,
                showlegend=row == 1,
                **line_of(policy, ink),
            )
            tops[row - 1].append(float(np.nanquantile(y, 0.99)))
    tops[0].append(comparison.budget_ms)
    for row, top in enumerate(tops, 1):
        figure.update_yaxes(range=(0.0, _top(top)), row=row, col=1)
    figure.add_hline(y=comparison.budget_ms, row=1, col=1, line=BUDGET)
    figure.update_xaxes(title_text="time of the trace, s", row=4, col=1)
    return styled(figure, 860, comparison.ok)


def _top(tops: list[float]) -> float:
    """Return the end of an axis: all that is reached, or thrice what the middle policy reaches."""
    middle = float(np.median(tops))
    highest = max(tops)
    return 1.1 * (min(highest, 3.0 * middle) if middle > 0.0 else max(highest, 1e-6))


def distribution_chart(
    comparison: Comparison, logs: dict[str, FrameLog], ink: dict[str, Ink]
) -> Any:
    """Return how many frames take how long: work time, and interval between displays."""
    from plotly.subplots import make_subplots

    titles = ["Work time", "Interval between displays"]
    figure: Any = make_subplots(rows=1, cols=2, shared_yaxes=True, subplot_titles=titles)
    for policy in comparison.ok:
        run = Run(logs[policy.label], comparison.warmup)
        for column, values in enumerate((run.work_ms, run.frame_ms), 1):
            x, y = tail(values, 300)
            figure.add_scatter(
                x=shortened(x), y=shortened(100.0 * y), row=1, col=column, showlegend=column == 1,
                line_shape="vh", **line_of(policy, ink),
            )  # fmt: skip
    figure.add_vline(x=comparison.budget_ms, line=BUDGET)
    figure.update_yaxes(type="log", title_text="frames at least this slow, %", col=1)
    figure.update_yaxes(type="log", dtick=1)
    figure.update_xaxes(type="log", title_text="ms", tickvals=_TICKS_MS)
    return styled(figure, 350, comparison.ok)


def largest_steps(comparison: Comparison) -> list[Step]:
    """Return the steps to draw, in order of time: the largest rises that some policy met."""
    runs = [policy.steps for policy in comparison.ok if policy.steps]
    steps = max(runs, key=len, default=())
    rise = sorted(steps, key=lambda step: step.load_before_ms - step.load_after_ms)
    return sorted(rise[:_MOST_STEPS], key=lambda step: step.time_ms)


def step_chart(comparison: Comparison, logs: dict[str, FrameLog], ink: dict[str, Ink]) -> Any:
    """Return work over budget about each of the largest steps, or None where there is none."""
    from plotly.subplots import make_subplots

    steps = largest_steps(comparison)
    if not steps:
        return None
    columns = min(len(steps), 3)
    rows = -(-len(steps) // columns)
    titles = [
        f"{step.time_ms * 1e-3:.1f} s: load {step.load_before_ms:.1f} → {step.load_after_ms:.1f} ms"
        for step in steps
    ]
    figure: Any = make_subplots(
        rows=rows, cols=columns, shared_yaxes=True, subplot_titles=titles,
        vertical_spacing=0.5 / (2 * rows), horizontal_spacing=0.03,
    )  # fmt: skip
    for policy in comparison.ok:
        run = Run(logs[policy.label])
        time_s = run.time_s
        for i, step in enumerate(steps):
            since_s = time_s - step.time_ms * 1e-3
            near = (since_s >= -_BEFORE_S) & (since_s <= _AFTER_S)
            x, y = envelope(since_s[near], run.work_ms[near] / comparison.budget_ms, _BUCKETS)
            figure.add_scatter(
                x=shortened(x), y=shortened(y), row=1 + i // columns, col=1 + i % columns,
                showlegend=i == 0, **line_of(policy, ink),
            )  # fmt: skip
    figure.add_hline(y=1.0, line=BUDGET)
    figure.update_yaxes(rangemode="tozero")
    figure.update_yaxes(title_text="work / budget", col=1)
    figure.update_xaxes(title_text="s since the step", row=rows)
    return styled(figure, 90 + 260 * rows, comparison.ok)
