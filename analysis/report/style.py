"""What all charts of a page have in common."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ..study.comparison_parts import PolicyResult
from .palette import Ink

BUDGET = {"color": "#888888", "width": 1.2, "dash": "dash"}


def panels(rows: int, columns: int, **options: Any) -> Any:
    """Return a figure of panels; options are those of plotly's ``make_subplots``."""
    from plotly.subplots import make_subplots

    return make_subplots(rows=rows, cols=columns, **options)


def add_line(
    figure: Any, at: tuple[int, int], points: tuple[FloatArray, FloatArray],
    policy: PolicyResult, ink: Ink, *, first: bool, **options: Any,
) -> None:  # fmt: skip
    """Draw a policy's line into the panel of a row and column; the first one gives the legend."""
    # Single precision is all that a chart shows, and makes the page smaller.
    x, y = (values.astype(np.float32) for values in points)
    figure.add_scatter(
        x=x, y=y, row=at[0], col=at[1], showlegend=first, name=policy.label, mode="lines",
        legendgroup=policy.label, line={"color": ink.color, "dash": ink.dash, "width": 1.4},
        **options,
    )  # fmt: skip


def styled(figure: Any, height_px: int, named: Sequence[PolicyResult] = ()) -> Any:
    """Return the figure with what all have in common; the page sets colours for light and dark."""
    # The legend stands above, as many lines as its names need.
    legend_px = 26 * -(-sum(len(policy.label) + 7 for policy in named) // 150)
    figure.update_layout(
        height=height_px + legend_px,
        margin={"l": 60, "r": 12, "t": 38 + legend_px, "b": 48},
        paper_bgcolor="rgba(0,0,0,0)",
        plot_bgcolor="rgba(0,0,0,0)",
        font={"family": "system-ui, sans-serif", "size": 12, "color": "#808080"},
        legend={"orientation": "h", "x": 0, "y": 1.0, "yref": "container", "yanchor": "top"},
        hoverlabel={"namelength": -1},
        template="none",
    )
    line = {"gridcolor": "rgba(128,128,128,0.2)", "zeroline": False, "automargin": True}
    figure.update_xaxes(**line)
    figure.update_yaxes(**line)
    figure.update_annotations(font_size=12, selector={"showarrow": False})
    return figure
