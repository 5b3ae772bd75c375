"""What all plotly charts of a page have in common."""

from typing import Any

BUDGET = {"color": "#888888", "width": 1.2, "dash": "dash"}


def panels(rows: int, columns: int, **options: Any) -> Any:
    """Return a figure of panels; options are those of plotly's ``make_subplots``."""
    from plotly.subplots import make_subplots

    return make_subplots(rows=rows, cols=columns, **options)


def styled(figure: Any, height_px: int) -> Any:
    """Return the figure with what all have in common; the page sets colours for light and dark."""
    figure.update_layout(
        height=height_px,
        margin={"l": 60, "r": 12, "t": 38, "b": 48},
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
