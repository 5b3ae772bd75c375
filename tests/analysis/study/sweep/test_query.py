"""Conditions and means over results that were made up."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.engine.task import Failure
from lodbench.analysis.study.study import Study
from lodbench.analysis.study.sweep.query import Group, Query, Unscored
from lodbench.analysis.study.sweep.study_results import StudyResults, read_study_results
from lodbench.base.errors import InputError

MakeUp = Callable[[Study, Callable[[dict[str, Any]], Any]], Path]

BUDGETS = [4.0, 8.0, 16.0]


def outcome_of(cells: dict[str, Any]) -> Any:
    """Return 10 times the budget plus the seed; zach fails at 4 ms, hoppe has no settling time."""
    if cells["policy"] == "zach" and cells["budget_ms"] == 4.0:
        return Failure("failed", "no cut", frame=7)
    if cells["policy"] == "erikson":
        return Failure("not-applicable", "no tree")
    work_ms = 10.0 * cells["budget_ms"] + cells["seed"]
    settle_ms = None if cells["policy"] == "hoppe" else 1.0 + cells["seed"]
    return {"work_ms_p95": work_ms, "settle_ms": settle_ms}


@pytest.fixture
def results(make_up: MakeUp) -> StudyResults:
    """Return four policies under three budgets and two seeds."""
    study = Study(["zach", "hoppe", "erikson"], budget_ms=BUDGETS, seeds=2)
    return read_study_results(make_up(study, outcome_of))


def test_means_by_hand(results: StudyResults) -> None:
    """Means of the two seeds, in the order of the study, with every run counted by its fate."""
    groups = Query(results).groups(["policy", "budget_ms"], ["work_ms_p95", "settle_ms"])
    assert groups == [
        Group(("zach", 4.0), 0, 2, 0, (None, None), (0, 0)),
        Group(("zach", 8.0), 2, 0, 0, (80.5, 1.5), (2, 2)),
        Group(("zach", 16.0), 2, 0, 0, (160.5, 1.5), (2, 2)),
        Group(("hoppe", 4.0), 2, 0, 0, (40.5, None), (2, 0)),
        Group(("hoppe", 8.0), 2, 0, 0, (80.5, None), (2, 0)),
        Group(("hoppe", 16.0), 2, 0, 0, (160.5, None), (2, 0)),
        *(Group(("erikson", budget), 0, 0, 2, (None, None), (0, 0)) for budget in BUDGETS),
    ]


def test_who_has_no_scores_is_told(results: StudyResults) -> None:
    """Failures first, with their frame; the counts are of the runs that match."""
    assert Query(results).unscored() == [
        Unscored("zach", "failed", "no cut", 7, 2),
        Unscored("erikson", "not-applicable", "no tree", None, 6),
    ]
    assert Query(results, "seed = 0 and policy = 'zach'").unscored()[0].runs == 1
    texts = [one.text for one in Query(results).unscored()]
    assert texts == [
        "zach: 2 runs failed: frame 7: no cut", "erikson: 6 runs not applicable: no tree",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("where", "count"),
    [
        ("budget_ms < 10 and policy = 'hoppe'", 4),
        ("status = 'ok' and work_ms_p95 between 80 and 81", 4),
        ("policy like '%o%' or draw is not null", 12),
        ("seed = (select max(seed) from (values (0), (1)) as v(seed))", 9),
        (None, 18),
    ],
)
def test_conditions_choose_rows(results: StudyResults, where: str | None, count: int) -> None:
    """A condition is any expression of SQL over the columns, counted by hand."""
    assert len(Query(results, where)) == count


@pytest.mark.parametrize(
    ("where", "said"),
    [
        ("budgt_ms < 3", "got budgt_ms; did you mean budget_ms?"),
        ("wrk_ms_p95 < 3", "got wrk_ms_p95; did you mean work_ms_p95?"),
        ("policy = zach", "a text stands in single quotes: 'zach'"),
        ("policy = 3", "Could not convert string"),
        ("budget_ms <", "expected a condition such as"),
        ("", "expected a condition such as"),
        ("seed = 0; drop table runs", "expected a condition such as"),
        ("seed = 0) or (seed = 1", "expected a condition such as"),
        ("count(*) > 1", "WHERE clause cannot contain aggregates"),
    ],
)
def test_a_wrong_condition_is_one_line(results: StudyResults, where: str, said: str) -> None:
    """It names the nearest column or shows a condition that would do; nothing is executed."""
    with pytest.raises(InputError) as caught:
        Query(results, where)
    line = str(caught.value)
    assert said in line
    assert line.startswith("--where: ")
    assert "\n" not in line


def test_a_condition_reads_nothing_else(results: StudyResults, tmp_path: Path) -> None:
    """It reaches no file, no variable of the program, and no setting."""
    secret = tmp_path / "secret.csv"
    secret.write_text("a\n1\n", encoding="utf-8")
    for source in (f"read_csv('{secret}')", f"'{secret}'", "results", f"glob('{tmp_path}/*')"):
        with pytest.raises(InputError, match="--where: expected a condition"):
            Query(results, f"exists (select * from {source})")
