"""Turn sections into a page: one file that holds its style, scripts and data."""

from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .blocks import Section

if TYPE_CHECKING:  # jinja2 is loaded by what writes a page
    from jinja2 import Template

_TEMPLATES = Path(__file__).parent / "templates"
_CONFIG = {"displayModeBar": False, "responsive": True}


def render_page(title: str, subtitle: str, sections: Iterable[Section]) -> str:
    """Return the HTML of a page, which needs nothing else; the same sections, the same bytes."""
    from plotly.offline import get_plotlyjs

    return _template().render(
        title=title, subtitle=subtitle, sections=sections, plotly=get_plotlyjs(), draw=_draw
    )


@cache
def _template() -> "Template":
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template("page.html")


def _draw(figure: Any, name: str) -> str:
    return figure.to_html(
        full_html=False, include_plotlyjs=False, div_id=f"chart-{name}", config=_CONFIG
    )
