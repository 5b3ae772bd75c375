"""What all charts of a report have in common."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..study.comparison import PolicyResult
from .palette import Ink

BUDGET = {"color": "#888888", "width": 1.2, "dash": "dash"}


def line_of(policy: PolicyResult, ink: dict[str, Ink]) -> dict[str, Any]:
    """Return how the line of a policy is drawn and named."""
    drawn = ink[policy.label]
    return {
        "mode": "lines",
        "name": policy.label,
        "legendgroup": policy.label,
        "line": {"color": drawn.color, "dash": drawn.dash, "width": 1.4},
    }


def shortened(values: Sequence[float] | Any) -> Any:
    """Return values with the digits that a chart shows, which makes the page smaller."""
    return np.asarray(values, dtype=np.float32)


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
