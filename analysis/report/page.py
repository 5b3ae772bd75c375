"""Turn sections into a page: one file that holds its style, scripts and data."""

from collections.abc import Iterable, Sequence
from typing import Any

from .blocks import Cell, Chart, Section
from .page_template import page_template
from .plots import HIGH, LEVEL_STYLES, WIDE

_CONFIG = {"displayModeBar": False, "responsive": True}


def render_page(
    title: str,
    subtitle: str,
    sections: Iterable[Section],
    legend: Sequence[Cell] = (),
    drawn_at_first: int = 0,
) -> str:
    """Return the HTML of a page, which needs nothing else; the same sections, the same bytes.

    Parameters
    ----------
    legend : sequence of Cell
        What all plots draw, each with its ink; a click hides one in all of them.
    drawn_at_first : int
        How many of them are drawn until a reader says otherwise; 0 for all.
    """
    sections = list(sections)
    off = [cell.ink.index for cell in legend[drawn_at_first or len(legend) :] if cell.ink]
    return page_template("page.html").render(
        title=title, subtitle=subtitle, sections=sections, legend=legend, off=off,
        plotly=_plotly_for(sections), draw=_draw, wide=WIDE, high=HIGH, levels=LEVEL_STYLES,
    )  # fmt: skip


def _plotly_for(sections: Sequence[Section]) -> str:
    """Return the library of plotly's charts, 4.8 MB, where a page has one."""
    if not any(isinstance(block, Chart) for section in sections for block in section.blocks):
        return ""
    from plotly.offline import get_plotlyjs

    return get_plotlyjs()


def _draw(figure: Any, name: str) -> str:
    return figure.to_html(
        full_html=False, include_plotlyjs=False, div_id=f"chart-{name}", config=_CONFIG
    )
