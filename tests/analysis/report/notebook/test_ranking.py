"""A comparison in a notebook shows its ranking, in which every name is text."""

import re
from dataclasses import replace
from html.parser import HTMLParser

from lodbench.analysis.report.notebook.ranking import ranking_html
from lodbench.analysis.study.comparison_folder import Compared


class Fragment(HTMLParser):
    """Collects the tags of a part of a page, those left open, and for each text what it is in."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.open: list[str] = []
        self.folded = self.text = ""
        self.feed(html)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note a tag."""
        self.tags.add(tag)
        self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        """Close the innermost tag, which has to be this one."""
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        """Collect text, apart what is folded."""
        if "details" in self.open:
            self.folded += data
        elif "style" not in self.open:
            self.text += data


def test_who_keeps_the_budget_is_seen_and_who_misses_is_folded(
    compared: Compared, ordinary_name: str
) -> None:
    """Gate and rank of the one that keeps it stand open; full detail, which misses, is below."""
    comparison = compared.comparison
    first, full = comparison.ok
    assert (first.label, first.rank, full.label, full.rank) == (ordinary_name, 1, "full", None)
    shown = Fragment(ranking_html(comparison))
    assert shown.open == []
    assert "script" not in shown.tags
    assert "button" not in shown.tags, "no table is sorted without a script"
    for sentence in comparison.answer:
        assert sentence in shown.text
    assert first.keeps_budget is not None
    assert full.keeps_budget is not None
    assert f"{first.keeps_budget.kept}/{first.keeps_budget.paths}" in shown.text
    table = shown.text[shown.text.rindex("comes first") :]
    assert re.search(rf"1\s*{ordinary_name}", table)
    assert "full" not in table
    assert "1 not surely within the budget" in shown.folded
    ratio = full.keeps_budget.work_ms / comparison.budget_ms
    assert re.search(rf"{ratio:.2f} ×\s*full", shown.folded)
    assert "failed: fails: frame " in shown.text


def test_what_did_the_same_has_one_row(compared: Compared) -> None:
    """A policy that did what another did is named below the ranking, and has no row of its own."""
    comparison = compared.comparison
    first = comparison.ok[0]
    twin = replace(first, label="twin", same_as=first.label)
    html = ranking_html(replace(comparison, policies=(*comparison.policies, twin)))
    assert f"twin did the same as {first.label} in every run" in html
    assert "twin</td>" not in html


def test_names_are_text_in_the_ranking(hostile: Compared, compared: Compared) -> None:
    """A name of tags, quotes and dollars adds no tag to what another name makes."""
    html = ranking_html(hostile.comparison)
    assert "&lt;script&gt;alert" in html
    assert Fragment(html).tags == Fragment(ranking_html(compared.comparison)).tags
