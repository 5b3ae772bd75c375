"""Turn sections into a page: one file that holds its style, scripts and data."""

from collections.abc import Iterable, Sequence

from .blocks import Cell, Section
from .page_template import page_template
from .plots import HIGH, LEVEL_STYLES, WIDE


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
    off = [cell.ink.index for cell in legend[drawn_at_first or len(legend) :] if cell.ink]
    return page_template("page.html").render(
        title=title, subtitle=subtitle, sections=list(sections), legend=legend, off=off,
        wide=WIDE, high=HIGH, levels=LEVEL_STYLES,
    )  # fmt: skip
