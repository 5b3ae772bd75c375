"""The page on sweeps prints what it says: each command, and the text that is shown below it."""

import re
import shlex
from pathlib import Path

import pytest

from lodbench.cli.main import run

DOCS = Path(__file__).parents[2] / "docs"
FENCE = re.compile(r"^```(\w+)(?: file=(\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
MEASURED = re.compile(r"about \S+ \S+ on \d+ workers and \d+ kB")


def shown(text: str) -> str:
    """Return a text without what depends on the machine: how long and how large."""
    return MEASURED.sub("about TIME and SIZE", text)


@pytest.mark.slow
def test_the_page_prints_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every command of the page is run in order, and prints the block below it to the letter."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")
    blocks = FENCE.findall((DOCS / "sweeps.md").read_text(encoding="utf-8"))
    compared = 0
    for place, (language, name, block) in enumerate(blocks):
        if name:
            Path(name).write_text(block, encoding="utf-8")
        if language != "sh":
            continue
        assert run(shlex.split(block)[1:]) == 0
        printed = capsys.readouterr().out
        below, _, text = blocks[place + 1]
        if below != "text":  # a page is written, of which nothing is shown
            page = Path("budgets.html").read_text(encoding="utf-8").lower()
            assert page.startswith("<!doctype html>")
            assert "static-screen" in page
            continue
        assert shown(printed) == shown(text)
        compared += 1
    assert compared >= 7


def test_the_study_of_the_page_is_the_example() -> None:
    """What the page shows is the file that it links."""
    blocks = FENCE.findall((DOCS / "sweeps.md").read_text(encoding="utf-8"))
    (study,) = (block for _, name, block in blocks if name == "budgets.toml")
    example = DOCS / "examples" / "sweeps" / "budgets.toml"
    assert example.read_text(encoding="utf-8") == study
