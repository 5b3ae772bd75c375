"""The page on Python is a notebook: its blocks run in order and print what it says."""

import contextlib
import io
import re
from pathlib import Path

import pytest

from lodbench.policies.registry import REGISTERED

PAGE = Path(__file__).parents[1] / "docs" / "python.md"
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_page_prints_what_it_shows(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each ``python`` block prints the ``text`` block below it, or nothing if there is none."""
    monkeypatch.setattr(REGISTERED, "_users", {})
    blocks = FENCE.findall(PAGE.read_text(encoding="utf-8"))
    assert blocks
    namespace: dict[str, object] = {"__name__": "__main__"}
    for place, (language, block) in enumerate(blocks):
        if language != "python":
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile(block, f"{PAGE.name}, block {place}", "exec"), namespace)
        shown = [text for below, text in blocks[place + 1 : place + 2] if below == "text"]
        assert printed.getvalue() == "".join(shown)
