"""Tables and the summary: every number is there, and any name is shown as text."""

import csv
import html
import io
import re
from collections.abc import Callable
from dataclasses import replace
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.report.printed.csv_tables import csv_text
from lodbench.analysis.report.printed.latex_tables import latex_escape, latex_text
from lodbench.analysis.report.printed.markdown import comparison_markdown, markdown_escape
from lodbench.analysis.report.printed.tables import PrintedTable, printed_tables
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.analysis.verdict.changes import Change, Changes, PolicyChange
from lodbench.base.foreign_text import one_line

TAGS = {"h3", "p", "strong", "table", "thead", "tbody", "tr", "th", "td", "code", "sub"}
NAMES = st.text(st.characters(codec="utf-8"), max_size=80)


def rows_of(table: PrintedTable) -> list[list[str]]:
    """Return the cells of a table's CSV."""
    return list(csv.reader(io.StringIO(csv_text(table), newline="")))


def test_csv_holds_the_record(compared: Compared) -> None:
    """Each metric of each policy stands in full under its id, with both ends of its interval."""
    tables = [rows_of(t) for t in printed_tables(compared.comparison) if "metrics-" in t.name]
    found: dict[tuple[str, str], str] = {}
    for heads, *rows in tables:
        for row in rows:
            found |= {(row[0], head): cell for head, cell in zip(heads, row, strict=True)}
    for policy in compared.comparison.ok:
        for metric in METRICS:
            score = policy.metrics[metric.id]
            value = found[policy.label, metric.id]
            assert (float(value) if value else None) == score.value
            span = score.such_paths or score.this_path
            low = found[policy.label, f"{metric.id}_low"]
            assert (float(low) if low else None) == (None if span is None else span[0])


def test_tables_cover_the_page(compared: Compared) -> None:
    """Ranking, metrics, chances, curves, worst moments and what failed each have a table."""
    names = {table.name for table in printed_tables(compared.comparison)}
    assert {"ranking", "metrics-budget", "metrics-work", "curves", "worst-moments"} <= names
    (unscored,) = (t for t in printed_tables(compared.comparison) if t.name == "unscored")
    assert rows_of(unscored)[1][:2] == ["fails", "failed"]


def test_csv_of_any_name(hostile: Compared, hostile_name: str) -> None:
    """Quotes, commas and lines of a name come back as they were, in rows of one length."""
    for table in printed_tables(hostile.comparison):
        rows = rows_of(table)
        assert {len(row) for row in rows} == {len(rows[0])}
        assert len(rows) == 1 + len(table.rows)
    assert any(
        hostile_name in row for t in printed_tables(hostile.comparison) for row in rows_of(t)
    )


def read_latex(text: str) -> str:
    """Return what TeX would print of an escaped text; fails at anything that it would obey."""
    words = {
        r"\textbackslash{}": "\\", r"\textasciitilde{}": "~", r"\textasciicircum{}": "^",
        r"\textless{}": "<", r"\textgreater{}": ">", r"\textbar{}": "|", r"{\char34}": '"',
        r"\ldots{}": "…", "{'}": "'", "{`}": "`", "{[}": "[", "{*}": "*", "{-}": "-",
    } | {f"\\{mark}": mark for mark in "{}$&%#_"}  # fmt: skip
    pattern = "|".join(re.escape(word) for word in sorted(words, key=len, reverse=True))
    rest = re.sub(pattern, "", text)
    assert not set(rest) & set("\\{}$&%#_~^|<>\"'`[*"), rest
    return re.sub(pattern, lambda found: words[found.group()], text)


@given(NAMES)
def test_latex_prints_any_text(text: str) -> None:
    """What TeX reads is the text itself, in one line; dashes stay as many as they are."""
    escaped = latex_escape(text)
    assert "--" not in escaped.replace("–", "")
    assert "\n" not in escaped
    shown = one_line(text, 60)
    if "–" not in shown:
        assert read_latex(escaped) == shown


def test_latex_rows_have_their_columns(hostile: Compared) -> None:
    """Whatever the names, each row has as many cells as the tabular has columns."""
    for table in printed_tables(hostile.comparison):
        lines = latex_text(table).splitlines()
        (begin,) = (line for line in lines if line.startswith(r"\begin"))
        columns = len(begin.split("{")[2].rstrip("}"))
        rows = [line for line in lines if line.endswith(r" \\")]
        assert len(rows) == 1 + len(table.rows)
        for row in rows:
            assert len(re.findall(r"(?<!\\)&", row)) == columns - 1
            assert row.count("{") - row.count(r"\{") == row.count("}") - row.count(r"\}")
        marks = (r"\toprule", r"\midrule", r"\bottomrule")
        assert [line for line in lines if line in marks] == list(marks)


def test_latex_is_rounded(compared: Compared) -> None:
    """Three significant digits, the interval in small print, a dash for what there is not."""
    (ranking,) = (t for t in printed_tables(compared.comparison) if t.name == "ranking")
    assert re.search(r"& \d\.\d\d \{\\scriptsize \(\d\.\d+, \d\.\d+\)\}", latex_text(ranking))


class Shown(HTMLParser):
    """The tags and the text of a page."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: set[str] = set()
        self.text = ""
        self.cells: list[int] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note a tag; count the cells of rows."""
        self.tags.add(tag)
        if tag == "tr":
            self.cells.append(0)
        if tag in {"td", "th"}:
            self.cells[-1] += 1

    def handle_data(self, data: str) -> None:
        """Collect text."""
        self.text += data


def test_markdown_of_any_name(hostile: Compared, hostile_name: str) -> None:
    """Rendered, a name is the text that it is, and the table keeps its columns."""
    markdown = pytest.importorskip("markdown")
    page = Shown(markdown.markdown(comparison_markdown(hostile.comparison), extensions=["tables"]))
    assert page.tags <= TAGS
    assert set(page.cells) == {9}
    assert len(page.cells) == 1 + len(hostile.comparison.ok)
    assert one_line(hostile_name, 60) in page.text
    assert one_line(hostile_name, 1000) in " ".join(page.text.split())  # in the answer


@given(NAMES)
def test_markdown_escapes_to_entities(text: str) -> None:
    """Nothing is left that Markdown obeys, and entities are the text."""
    escaped = markdown_escape(text)
    assert not set(escaped.replace("<!-- -->", "")) & set("<>|`*_[]\\~$!\n")
    assert html.unescape(escaped.replace("<!-- -->", "")) == one_line(text, 1000)


def test_long_names_are_cut(renamed: Callable[[str], Compared]) -> None:
    """Ten thousand characters fill no page: names are cut in tables, sentences later."""
    long = renamed("A" * 10_000)
    text = comparison_markdown(long.comparison)
    assert max(map(len, text.splitlines())) < 4000
    assert f"<code>{'A' * 59}…</code>" in text
    for table in printed_tables(long.comparison):
        assert "A" * 300 not in latex_text(table)


def test_markdown_says_the_answer(compared: Compared, ordinary_name: str) -> None:
    """The answer comes first, then each policy with its rank; what failed has its reason."""
    text = comparison_markdown(compared.comparison)
    assert text.startswith("### Which policy keeps 8 ms?\n\n")
    plain = html.unescape(text.replace("<!-- -->", ""))
    for sentence in compared.comparison.answer:
        assert sentence in plain
    assert f"| 1 | <code>{ordinary_name}</code> |" in plain
    assert "**failed:** fails: frame 70" in plain


def test_markdown_tells_changes(compared: Compared, ordinary_name: str) -> None:
    """Against a baseline only what changed beyond noise is listed, and whether it is worse."""
    change = Change(
        ordinary_name, "work_ms_mean", "ms", "lower", 5.0, 6.0, 0.8, 1.2, beyond_noise=True
    )
    noise = replace(change, metric="lag_ms_mean", beyond_noise=False)
    place = PolicyChange(ordinary_name, 1, 2, "bias=1", "bias=2", "triangles", "gpu", 1.5)
    changes = Changes(True, ("miss 0.01, now 0.02",), (place,), (change, noise), ("gone",), ())
    text = html.unescape(comparison_markdown(compared.comparison, changes))
    assert "1 of 2 metrics changed beyond noise" in text
    row = f"| <code>{ordinary_name}</code> | work_ms_mean | 5.00 | 6.00 | +1 (+0.8, +1.2) | worse |"
    assert row in text
    assert "lag_ms_mean" not in text
    for sentence in (
        "not under the same conditions: miss 0.01, now 0.02",
        f"- {ordinary_name}: rank 1, now rank 2",
        f"- {ordinary_name}: on the first path the cost of triangles changed most, by +1.5 ms",
        "- gone was scored in the first only",
    ):
        assert sentence in text
