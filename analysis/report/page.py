"""What all pages have in common: style, scripts, and charts as parts of them."""

from pathlib import Path
from string import Template
from typing import Any

_FOLDER = Path(__file__).parent
_CONFIG = {"displayModeBar": False, "responsive": True}


def fill_page(body: Path, *, title: str, **parts: str) -> str:
    """Return a whole page, which needs nothing else, from a template of its body."""
    from plotly.offline import get_plotlyjs

    return Template((_FOLDER / "shell.html").read_text(encoding="utf-8")).substitute(
        title=title,
        style=(_FOLDER / "page.css").read_text(encoding="utf-8"),
        plotly=get_plotlyjs(),
        body=Template(body.read_text(encoding="utf-8")).substitute(parts, title=title),
    )


def chart_html(name: str, figure: Any) -> str:
    """Return a chart as a part of the page, or say that there is nothing to draw."""
    if figure is None:
        return '<p class="dim">Nothing to draw in this run.</p>'
    return figure.to_html(
        full_html=False, include_plotlyjs=False, div_id=f"chart-{name}", config=_CONFIG
    )
