"""What a notebook shows, in a browser: the ranking without a script, and figures by plotly."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest

from lodbench.analysis.report.notebook.ranking import ranking_html
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.comparison_folder import Compared

pytestmark = pytest.mark.slow

Open = Callable[..., Any]
NAME = "<script>alert(1)</script> & <b>$x^2$</b>"


@pytest.fixture
def named(compared: Compared) -> Comparison:
    """Return the comparison, in which full detail has a name of markup."""
    text = msgspec.json.encode(compared.comparison).decode()
    return msgspec.json.decode(text.replace('"full"', f'"{NAME}"'), type=Comparison)


def test_who_misses_is_folded_and_opened(
    open_page: Open, named: Comparison, tmp_path: Path
) -> None:
    """A click opens the fold, where the name is text."""
    path = tmp_path / "cell.html"
    head = "<!doctype html><meta charset=utf-8><title>cell</title>"
    path.write_text(head + ranking_html(named), encoding="utf-8")
    page = open_page(path.as_uri())
    missed = page.locator("td", has_text=NAME)
    assert missed.count() == 1
    assert not missed.is_visible()
    page.locator("summary", has_text="not surely within the budget").click()
    assert missed.is_visible()


def test_figures_show_names_as_they_are(open_page: Open, named: Comparison, tmp_path: Path) -> None:
    """Plotly reads tags, entities and TeX in texts; its legend has the name, letter by letter."""
    path = tmp_path / "figure.html"
    named.figure("tradeoff").write_html(path, include_plotlyjs=True)
    page = open_page(path.as_uri())
    page.wait_for_selector(".legendtext")
    shown = page.eval_on_selector_all(".legendtext", "els => els.map(e => e.textContent)")
    assert NAME in shown
    assert len(shown) == len(named.ok)
