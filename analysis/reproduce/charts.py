"""Pictures of experiments as SVG, the same bytes for the same numbers."""

from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ...base.errors import InputError
from ...base.files.whole_file import whole_file
from .experiment import Chart

_WIDTH_IN, _HEIGHT_IN = 6.0, 3.6
# Okabe and Ito's colours, which the colour-blind tell apart; what is printed is black.
_COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442")
_PRINTED = "#000000"
_SETTINGS: Any = {"svg.hashsalt": "lodbench", "svg.fonttype": "none", "font.size": 9.0}


def require_charts() -> None:
    """Raise `InputError` if there is nothing to draw charts with."""
    if find_spec("matplotlib") is None:
        raise InputError("charts: expected matplotlib, got none; pip install 'lodbench[fit-plots]'")


def write_chart(chart: Chart, path: Path) -> None:
    """Write a chart as SVG."""
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with mpl.rc_context(_SETTINGS):
        figure = Figure(figsize=(_WIDTH_IN, _HEIGHT_IN), layout="constrained")
        FigureCanvasSVG(figure)
        axes: Any = figure.add_subplot()
        colours = iter(_COLOURS * (1 + len(chart.lines) // len(_COLOURS)))
        for line in chart.lines:
            style = "o--" if line.printed else "o-" if len(line.x) <= 20 else "-"
            colour = _PRINTED if line.printed else next(colours)
            axes.plot(line.x, line.y, style, color=colour, label=line.label, ms=3.5, lw=1.2)
        axes.set_xlabel(chart.x)
        axes.set_ylabel(chart.y)
        if chart.log_x:
            axes.set_xscale("log")
        if chart.log_y:
            axes.set_yscale("log")
        axes.grid(visible=True, color="#dddddd", lw=0.6)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, fontsize=8.0)
        with whole_file(path) as partial:
            figure.savefig(partial, format="svg", metadata={"Date": None})
