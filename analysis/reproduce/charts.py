"""Pictures of experiments as SVG, the same bytes for the same numbers."""

from pathlib import Path
from typing import Any

from ..report.palette import COLORS
from ..report.printed.drawing import (
    clear_spines,
    drawing_style,
    new_figure,
    require_matplotlib,
    save_figure,
)
from .experiment import Chart

_WIDTH_IN, _HEIGHT_IN = 6.0, 3.6
_PRINTED = "#000000"
"""The colour of what a paper printed."""


def require_charts() -> None:
    """Raise `InputError` if there is nothing to draw charts with."""
    require_matplotlib("charts")


def write_chart(chart: Chart, path: Path) -> None:
    """Write a chart as SVG."""
    with drawing_style(9.0):
        figure = new_figure(_WIDTH_IN, _HEIGHT_IN)
        axes: Any = figure.add_subplot()
        colors = iter(COLORS * (1 + len(chart.lines) // len(COLORS)))
        for line in chart.lines:
            style = "o--" if line.printed else "o-" if len(line.x) <= 20 else "-"
            color = _PRINTED if line.printed else next(colors)
            axes.plot(line.x, line.y, style, color=color, label=line.label, ms=3.5, lw=1.2)
        axes.set_xlabel(chart.x)
        axes.set_ylabel(chart.y)
        if chart.log_x:
            axes.set_xscale("log")
        if chart.log_y:
            axes.set_yscale("log")
        clear_spines(axes)
        axes.legend(frameon=False, fontsize=8.0)
        save_figure(figure, path)
