"""Templates of pages: names and texts of users are text in all of them."""

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # jinja2 is loaded by what writes a page
    from jinja2 import Template

_SHELL = Path(__file__).parent / "templates"


@cache
def page_template(name: str, folder: Path = _SHELL) -> "Template":
    """Return a template of a folder, which may include those of the report's own."""
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    environment = Environment(
        loader=FileSystemLoader([folder, _SHELL]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template(name)
