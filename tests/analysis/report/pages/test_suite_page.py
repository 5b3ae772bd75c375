"""The leaderboard's page: who leads, every cell, and every name as text."""

import re
from dataclasses import replace

from lodbench.analysis.report.pages.suite_page import render_suite
from lodbench.analysis.study.suite.run_suite import lead
from lodbench.analysis.study.suite.suite_record import CellResult, Standing, SuiteResult

HOSTILE = '</script><script>alert("x")</script>&'
SCORED = Standing("", "ok", None, 1, 0.95, "k=1", 6.0, 0.5, 0.0, 5.0)


def suite_of(mine: str) -> SuiteResult:
    """Return two comparisons: `a` is first in both, `mine` second, then refused with a reason."""
    missed = replace(SCORED, label="b", rank=None, keeps=0.41, work_ms_p99=12.0)
    unfit = Standing(
        "b", "not-applicable", "flat scenes only", None, None, "", None, None, None, None
    )
    failed = replace(unfit, label=mine, status="failed", reason=f"raised {HOSTILE}")
    first = replace(SCORED, label="a")
    standings = (
        (first, replace(SCORED, label=mine, rank=2, visible_error_px=0.7), missed),
        (first, failed, unfit),
    )
    cells = tuple(
        CellResult(
            f"cell-{at}", "scene", "walk", "machine", 8.0, ("walk-0",), (f"Take a {at}.",),
            (f"warned {HOSTILE}",) if at else (), {"scene": "12ab"}, some,
        )
        for at, some in enumerate(standings)
    )  # fmt: skip
    return SuiteResult("tiny", 1, "34cd", "lodbench suite tiny", "0", "ef", lead(cells, [mine]),
                       cells)  # fmt: skip


def test_the_page_is_the_leaderboard_of_the_record() -> None:
    """Places, ranks, probabilities and fates stand in the row of each policy, in order."""
    page = render_suite(suite_of("mine"))
    assert "a leads: it keeps the budget of 2 of 2 comparisons, at a mean rank of 1.0." in page
    assert "mine, submitted, is in place 2 of 3: 1 of 2 kept." in page
    body = re.findall(r'<table class="ranking".*?<tbody>(.*?)</tbody>', page, re.DOTALL)[0]
    rows = [
        [re.sub(r"<.*?>", "", cell).strip() for cell in re.findall(r"<t[hd].*?</t[hd]>", row)]
        for row in body.split("</tr>")[:-1]
    ]
    assert rows == [
        ["1", "a", "2/2", "1.0", "1", "1"],
        ["2", "mine submitted", "1/2", "2.0", "2", "failed"],
        ["3", "b", "0/2", "–", "p 0.41", "n/a"],
    ]
    assert '<a href="cell-1/report.html">2: cell-1</a>' in page
    assert "Take a 0." in page
    assert "a draws the finest picture within it, 0.500 px." in page
    assert page == render_suite(suite_of("mine"))


def test_names_reasons_and_warnings_are_text() -> None:
    """What a user named or raised adds no tag, and long names are cut."""
    long = HOSTILE + "é" * 10_000
    page = render_suite(suite_of(long))
    assert page.count("<script>") == 1
    assert "&lt;script&gt;alert" in page
    assert not re.search("é{600,}", page)


def test_a_suite_whose_budgets_nobody_keeps_has_no_leader() -> None:
    """It says so, and draws what there is."""
    result = suite_of("mine")
    cell = result.cells[0]
    missed = tuple(replace(one, rank=None, keeps=0.1) for one in cell.standings)
    cells = (replace(cell, standings=missed),)
    page = render_suite(replace(result, cells=cells, leaderboard=lead(cells, [])))
    assert "Nobody surely keeps any budget." in page
    assert "Nobody surely keeps the budget." in page
    assert "leads" not in page
