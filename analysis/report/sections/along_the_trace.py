"""Plots over the time of the first path: work, lag, switches and error."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from ...metrics.budget import over_budget_time_fraction
from ...metrics.measured_frames import MeasuredFrames
from ..blocks import Paragraph
from ..palette import Ink
from ..plots import Axis, Plot, Plots, Rule, Scale, line_of
from ..results import Results, section
from ..series import envelope
from ..values import counted, format_value

_BUCKETS = 500
_BIN_S = 0.5
_MOST = 2.0
"""Work that is drawn, in budgets."""
TIME = "time of the path, s"
_ANYBODY = Ink("", "solid", "")
LINK = "time"
"""Plots along the first path are zoomed together."""


def _in_short(results: Results) -> str:
    over = {p.label: over_budget_time_fraction(results.first_path(p.label)) for p in results.drawn}
    first = over[results.first.label]
    if first is None:
        return ""
    never = sum(share == 0.0 for share in over.values())
    return (
        f"{results.first.label} is over the budget for {format_value(first, percent=True)} % of "
        f"the time of this path; {never} of {counted(len(over), 'policy', 'policies')} never."
    )


@section("Along the first path", takeaway=_in_short)
def along_the_trace(results: Results) -> tuple[Plots] | tuple[Paragraph]:
    """Every chart along the path is zoomed with the others.

    Where frames are too many to draw, minima and maxima are kept.  Load is the GPU time that full
    detail of what is in view would take: it is the path's, whatever a policy does.  Work is drawn
    up to twice the budget, lag and error up to twice the middle policy's: what lies above leaves
    the plot.  Switches are on a scale of square roots.
    """
    if not results.drawn:
        return (Paragraph("Nothing to draw in this run.", "dim"),)
    return (Plots(list(_plots(results)), zoom=LINK),)


def time_axis(results: Results) -> Axis:
    """Return the axis of time along the first path."""
    ends = [float(results.logs[p.label]["input_ns"][-1]) * 1e-9 for p in results.drawn]
    return Axis(TIME, 0.0, max(ends), parts=8)


@dataclass(frozen=True, slots=True)
class _Panel:
    """A chart along the path: what it draws of a run, and on which scale."""

    name: str
    title: str
    unit: str
    series: Callable[[MeasuredFrames], tuple[FloatArray, FloatArray]]
    scale: Scale = "linear"


def _plots(results: Results) -> Iterator[Plot]:
    runs = {p.label: MeasuredFrames(results.logs[p.label]) for p in results.drawn}
    x, budget = time_axis(results), results.comparison.budget_ms
    yield _load(runs[results.first.label], x)
    for panel in _PANELS:
        series = {label: panel.series(run) for label, run in runs.items()}
        judged = panel.name == "work"
        top = _MOST * budget if judged else _top([y for _, y in series.values()], panel.scale)
        y = Axis(panel.unit, 0.0, top, panel.scale)
        lines = [
            line_of(results.inks[label], (x, y), envelope(*points, _BUCKETS))
            for label, points in series.items()
        ]
        text = f"budget {budget:.4g} ms"
        rules = [Rule(False, round(100.0 * y.at(budget), 2), text)] if judged else []
        height_px = 260 if judged else 150
        yield Plot(
            panel.name, panel.title, x, y, lines, rules=rules, height_px=height_px, link=LINK
        )


def _load(run: MeasuredFrames, x: Axis) -> Plot:
    """Return what is in view at full detail; no policy's, so that no click hides it."""
    load_ms = run["full_gpu_ms"]
    y = Axis("load, ms", 0.0, 1.1 * max(float(np.nanmax(load_ms, initial=0.0)), 1e-6))
    line = line_of(_ANYBODY, (x, y), envelope(run.time_s, load_ms, _BUCKETS))
    title = "Load: GPU time of all that is in view, at full detail"
    return Plot("load", title, x, y, [line], height_px=110, link=LINK)


def _work(run: MeasuredFrames) -> tuple[FloatArray, FloatArray]:
    return run.time_s, run.work_ms


def _lag(run: MeasuredFrames) -> tuple[FloatArray, FloatArray]:
    return run.time_s, run.lag_ms


def _error(run: MeasuredFrames) -> tuple[FloatArray, FloatArray]:
    return run.time_s, run["sse_px_p95"]


def _pops(run: MeasuredFrames) -> tuple[FloatArray, FloatArray]:
    edges = np.arange(0.0, run.time_s[-1] + _BIN_S, _BIN_S)
    counts = np.histogram(run.time_s, edges, weights=run["visible_pops"])[0]
    return 0.5 * (edges[1:] + edges[:-1]), counts / _BIN_S


def _top(series: list[FloatArray], scale: Scale) -> float:
    """Return the end of an axis: all that is reached, or twice what the middle policy reaches."""
    tops = [float(np.nanquantile(values, 0.99)) for values in series if not np.isnan(values).all()]
    highest = max([*tops, 1e-6])
    middle = float(np.median(tops)) if tops else 0.0
    if scale == "root" or middle <= 0.0:
        return 1.1 * highest
    return 1.1 * min(highest, 2.0 * middle)


_PANELS = (
    _Panel("work", "Work time", "work, ms", _work),
    _Panel("lag", "Lag from input to display", "lag, ms", _lag),
    _Panel("pops", f"Visible pops, over {_BIN_S:g} s", "visible pops, /s", _pops, "root"),
    _Panel("error", "Projected error, 95th percentile of nodes", "error, px", _error),
)
