"""Answers from made-up results: their tables in each form, and what is said beside them."""

import csv
import io
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.engine.task import Failure
from lodbench.analysis.study.study import Study
from lodbench.analysis.study.sweep.answer import find_answer
from lodbench.analysis.study.sweep.plain_table import PlainTable, csv_text, fitting, latex_text
from lodbench.base.errors import InputError

MakeUp = Callable[[Study, Callable[[dict[str, Any]], Any]], Path]


def outcome_of(cells: dict[str, Any]) -> Any:
    """Return a work time that budget and seed add up to, 1/3 for an endless fraction."""
    if cells["policy"] == "zach" and cells["seed"] == 3:
        return Failure("failed", "50 % & more_", frame=None)
    return {"work_ms_p95": cells["budget_ms"] + cells["seed"] / 3, "sse_px_p95": None}


@pytest.fixture
def folder(make_up: MakeUp) -> Path:
    """Return two policies under two budgets and four seeds."""
    return make_up(Study(["full", "zach"], budget_ms=[4, 8], seeds=4), outcome_of)


def test_csv_has_every_digit(folder: Path) -> None:
    """A list as CSV reads back to the numbers of the results, bit for bit and run by run."""
    answer = find_answer(folder, metrics=["work_ms_p95", "sse_px_p95"])
    read = list(csv.DictReader(io.StringIO(csv_text(answer.exact))))
    assert len(read) == 16
    assert list(read[0]) == [
        "policy", "scene", "trace", "hardware", "budget_ms", "draw", "seed", "status",
        "work_ms_p95", "sse_px_p95",
    ]  # fmt: skip
    ok = [row for row in read if row["status"] == "ok"]
    assert all(
        float(row["work_ms_p95"]) == float(row["budget_ms"]) + int(row["seed"]) / 3 for row in ok
    )
    assert {row["work_ms_p95"] for row in read if row["status"] != "ok"} == {""}
    assert {row["sse_px_p95"] for row in read} == {""}


def test_a_pivot_goes_across(folder: Path) -> None:
    """The last axis makes columns; a mean over fewer runs has their number behind it."""
    answer = find_answer(folder, pivot=["policy", "budget_ms"], metrics=["work_ms_p95"])
    (table,) = answer.tables
    assert table.header == ("policy", "budget_ms=4", "budget_ms=8")
    assert list(table.shown()) == [
        ["full", "4.50 (4)", "8.50 (4)"], ["zach", "4.33 (3)", "8.33 (3)"],
    ]  # fmt: skip
    assert table.title == "work_ms_p95, ms: means (runs)"
    assert answer.exact.header == (
        "policy", "budget_ms", "ok", "failed", "not_applicable", "work_ms_p95", "work_ms_p95_runs",
    )  # fmt: skip
    assert [row[:5] for row in answer.exact.rows][-1] == ("zach", 8.0, 3, 1, 0)
    assert answer.notes == ["zach: 2 runs failed: 50 % & more_"]
    even = find_answer(
        folder, where="policy = 'full'", pivot=["scene", "budget_ms"], metrics=["work_ms_p95"]
    )
    assert even.tables[0].title == "work_ms_p95, ms: means over 4 runs"
    assert list(even.tables[0].shown()) == [["plaza", "4.50", "8.50"]]
    assert even.notes == []


def test_a_pivot_of_one_axis_has_all_metrics(folder: Path) -> None:
    """A row a value with the runs that have scores; a metric that none has is a dash."""
    answer = find_answer(folder, pivot=["seed"], metrics=["work_ms_p95", "sse_px_p95"])
    (table,) = answer.tables
    assert list(table.shown()) == [
        ["0", "4", "6.00", "–"], ["1", "4", "6.33", "–"], ["2", "4", "6.67", "–"],
        ["3", "2", "7.00", "–"],
    ]  # fmt: skip


def test_latex_can_be_pasted() -> None:
    """Every character that TeX takes for its own is escaped, and rules are those of booktabs."""
    table = PlainTable("a_b", ("p_1", "x"), [("50 % & {~^\\} #$", 0.5), ("–", None)], ("p_1",))
    assert latex_text(table).splitlines() == [
        "% a_b",
        r"\begin{tabular}{lr}",
        r"\toprule",
        r"p\_1 & x \\",
        r"\midrule",
        r"50 \% \& \{\textasciitilde{}\textasciicircum{}\textbackslash{}\} \#\$ & 0.500 \\",
        r"-- & -- \\",
        r"\bottomrule",
        r"\end{tabular}",
    ]


def test_a_table_that_is_too_wide_is_cut_into_some() -> None:
    """Each has the columns of names, and together they have all others once, in order."""
    header = ("name", *(f"x={number}" for number in range(10)))
    table = PlainTable("t", header, [("abc", *map(float, range(10)))], ("name",), ("name",))
    parts = fitting(table, 40)
    assert len(parts) > 1
    assert [part.header[0] for part in parts] == ["name"] * len(parts)
    assert [name for part in parts for name in part.header[1:]] == list(header[1:])
    # Columns are a line, two spaces and the wider of header and cells: 7 for the name, 6 or 7.
    assert all(1 + sum(3 + len(name) for name in part.header) <= 40 for part in parts)
    assert fitting(table, 200) == [table]


def test_sensitivity_is_that_of_the_sum(folder: Path) -> None:
    """Work is budget plus seed / 3: by hand, 4 of the budget beside (5/3) / 9 of a run's noise."""
    answer = find_answer(
        folder, where="policy = 'full'", sensitivity=True, metrics=["work_ms_p95", "sse_px_p95"]
    )
    shares = {(row[0], row[1]): row[2] for row in answer.exact.rows}
    noise = 5 / 3 / 9
    assert shares == {
        ("work_ms_p95", "budget_ms"): pytest.approx(4 / (4 + noise)),
        ("work_ms_p95", "together"): pytest.approx(0.0, abs=1e-9),
        ("work_ms_p95", "noise of seeds"): pytest.approx(noise / (4 + noise)),
    }
    assert answer.notes == ["sse_px_p95: 8 of 8 runs have none, so no shares"]


def test_json_counts_every_run(folder: Path) -> None:
    """One record of any question: how many runs match, and what became of each."""
    record = json.loads(json.dumps(find_answer(folder, pivot=["policy"]).record(), allow_nan=False))
    assert record["schema"] == "lodbench.sweep-show/1"
    assert [record[key] for key in ("runs", "done", "matching", "ok", "failed")] == [
        16, 16, 16, 14, 2,
    ]  # fmt: skip
    assert record["ok"] + record["failed"] + record["not_applicable"] == record["matching"]
    assert [row["policy"] for row in record["pivot"]] == ["full", "zach"]
    assert record["unscored"] == [
        {"policy": "zach", "status": "failed", "reason": "50 % & more_", "frame": None, "runs": 2}
    ]


@pytest.mark.parametrize(
    ("question", "said"),
    [
        ({"pivot": ["polcy"]}, "--pivot: expected one of .* did you mean policy"),
        ({"pivot": ["policy", "policy"]}, "--pivot: expected each once, got policy twice"),
        ({"metrics": ["work_p95"]}, "--metric: expected one of .* did you mean work_ms_p95"),
        ({"where": "seed > 7"}, "expected a condition that holds for a run, got none"),
        ({"pivot": ["policy"], "sensitivity": True}, "expected no --sensitivity beside it"),
        (
            {"where": "seed = 0 and budget_ms = 4 and policy = 'full'", "sensitivity": True},
            "two values of an axis",
        ),
    ],
)
def test_a_question_that_cannot_be_answered(
    folder: Path, question: dict[str, Any], said: str
) -> None:
    """It is refused in one line, and never answered by an empty table."""
    with pytest.raises(InputError, match=said):
        find_answer(folder, **question)
