"""The page of a study: means over each axis, shares with intervals, and every name as text."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.report.pages.sweep_page import render_sweep
from lodbench.analysis.study.engine.task import Failure
from lodbench.analysis.study.study import Study
from lodbench.analysis.study.sweep.query import Query
from lodbench.analysis.study.sweep.study_results import StudyResults, read_study_results

MakeUp = Callable[[Study, Callable[[dict[str, Any]], Any]], Path]
HOSTILE = "<script>alert('x')</script>"
METRIC = "work_ms_p99"


def outcome_of(cells: dict[str, Any]) -> Any:
    """Return a time that is the budget, and 1 ms longer where the display is vsync."""
    late = 1.0 if cells.get("display") == "vsync" else 0.0
    return {METRIC: cells["budget_ms"] + late, "visible_error_px": 2.0}


@pytest.fixture
def results(make_up: MakeUp) -> StudyResults:
    """Return two policies, one with a name of markup, under budgets, displays and seeds."""
    study = Study(
        {HOSTILE: "full", "zach": "zach"},
        budget_ms=[4.0, 8.0, 12.0],
        display=["vsync", "immediate"],
        seeds=4,
    )
    return read_study_results(make_up(study, outcome_of))


def test_each_metric_is_drawn_over_each_axis(results: StudyResults) -> None:
    """Worked by hand: at 4 ms the mean over displays is 4.5; budgets make 128/131 of it."""
    page = render_sweep(Query(results), [METRIC, "visible_error_px"])
    charts = dict(re.findall(r'id="chart-([\w-]+)"(.*?)</figure>', page, re.DOTALL))
    assert set(charts) == {
        "multiple-0-0", "multiple-0-1", "multiple-1-0", "multiple-1-1", "shares-0",
    }  # fmt: skip
    titles = {re.findall(r"<figcaption>(.*?)<", chart)[0] for chart in charts.values()}
    assert f"{METRIC} over budget_ms, ms" in titles
    assert f"{METRIC} over display, ms" in titles
    said = [hint for chart in charts.values() for hint in re.findall(r'data-t="(.*?)"', chart)]
    assert f"zach: budget_ms 4; {METRIC}, ms 4.50, mean of 8 runs" in said
    assert f"zach: display vsync; {METRIC}, ms 9.00, mean of 12 runs" in said
    share = 128 / 131  # the variance of 4, 8, 12 is 32/3, that of 0 and 1 is 1/4
    assert f"budget_ms explains most: {share:.3f} ({share:.3f} to {share:.3f})." in page
    assert "visible_error_px: the same in all runs" in page
    assert page == render_sweep(Query(results), [METRIC, "visible_error_px"])


def test_names_of_axes_have_points_and_numbers_have_lines(results: StudyResults) -> None:
    """No line leads from one name to another, as if there were something between them."""
    page = render_sweep(Query(results), [METRIC])
    charts = dict(re.findall(r'id="chart-([\w-]+)"(.*?)</figure>', page, re.DOTALL))
    drawn = {
        re.findall(r"over (\w+),", chart)[0]: 'class="line' in chart
        for name, chart in charts.items()
        if name.startswith("multiple")
    }
    assert drawn == {"budget_ms": True, "display": False}


def test_names_and_reasons_are_text(make_up: MakeUp, results: StudyResults) -> None:
    """A policy's name, a reason and a condition add no tag to the page."""
    where = f"policy = '{HOSTILE.replace(chr(39), chr(39) * 2)}'"
    page = render_sweep(Query(results, where), [METRIC], where)
    assert page.count("<script>") == 1
    assert "&lt;script&gt;alert(" in page
    assert "24 runs" in page


def test_what_cannot_be_split_says_why(make_up: MakeUp) -> None:
    """A single run has means and no shares; runs that failed are named with the reason."""

    def fails(cells: dict[str, Any]) -> Any:
        return Failure("failed", HOSTILE, frame=3) if cells["policy"] == "zach" else {METRIC: 1.0}

    results = read_study_results(make_up(Study(["full", "zach"], budget_ms=4.0), fails))
    page = render_sweep(Query(results), [METRIC])
    assert "expected two values of an axis in a full grid" in page
    assert "zach: 1 run failed: frame 3: &lt;script&gt;" in page
    assert "No axis but the policy has two values." in page
    assert page.count("<script>") == 1
