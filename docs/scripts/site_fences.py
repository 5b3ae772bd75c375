"""What mkdocs is told of a fence: ``file=NAME`` is its title, ``exit=N`` is for the tests alone."""

import re
from typing import Any

_FILE = re.compile(r"^(```\w+) file=(\S+)$", re.MULTILINE)
_EXIT = re.compile(r"^(```sh) exit=\d+$", re.MULTILINE)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Return a page whose fences every Markdown reader understands."""
    return _EXIT.sub(r"\1", _FILE.sub(r'\1 title="\2"', markdown))
