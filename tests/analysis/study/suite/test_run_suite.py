"""A suite ranks policies over its cells; what fails, fails alone; what is done is not repeated."""

from collections.abc import Generator
from contextlib import contextmanager
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.comparison_parts import Status
from lodbench.analysis.study.runs import Progress
from lodbench.analysis.study.suite.definition import SUITES, Cell, Suite, find_suite
from lodbench.analysis.study.suite.run_suite import lead, run_suite
from lodbench.analysis.study.suite.suite_record import CellResult, Standing, SuiteResult
from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import encode_record
from lodbench.policies.policy_spec import PolicySpec, is_oracle
from lodbench.policies.registry import default_policies, parse_policy

TINY = Suite(
    name="tiny",
    version=1,
    policies=("full", "static-screen"),
    cells=(
        Cell("plaza", "fly-over", "desktop-assumed", 6.0),
        Cell("plaza", "walk", "desktop-assumed", 40.0),
    ),
    paths=3,
    length_s=2.0,
    seeds=1,
)


def cell_of(**standings: int | Status | None) -> CellResult:
    """Return a cell in which policies have a rank, miss the budget, or a status without scores."""
    made = tuple(
        Standing(
            label=label,
            status="ok" if what is None or isinstance(what, int) else what,
            reason=None,
            rank=what if isinstance(what, int) else None,
            keeps=None,
            knob="",
            work_ms_p99=None,
            visible_error_px=None,
            visible_pops_per_s=None,
            work_ms_mean=None,
        )
        for label, what in standings.items()
    )
    return CellResult("cell", "scene", "walk", "machine", 8.0, (), (), (), {}, made)


def test_the_order_is_by_budgets_kept_then_by_rank() -> None:
    """Worked by hand: `a` keeps 3 at a mean of 2; `b` and `c` keep 2 at 1.5; `d` keeps 1 at 1."""
    cells = [
        cell_of(a=2, b=1, c=2, d="not-applicable", e="failed"),
        cell_of(a=2, b=2, c=1, d=1, e="failed"),
        cell_of(a=2, b=None, c="not-applicable", d=None, e="failed"),
    ]
    leaders = lead(cells, ["c"])
    assert [(one.place, one.label, one.kept, one.mean_rank) for one in leaders] == [
        (1, "a", 3, 2.0),
        (2, "b", 2, 1.5),
        (2, "c", 2, 1.5),
        (4, "d", 1, 1.0),
        (5, "e", 0, None),
    ]
    assert [one.label for one in leaders if one.submitted] == ["c"]
    assert [(one.failed, one.not_applicable) for one in leaders] == [
        (0, 0),
        (0, 0),
        (0, 1),
        (0, 1),
        (3, 0),
    ]


def test_the_hash_changes_with_anything_in_the_definition() -> None:
    """Every field counts, so that results with one hash were asked the same."""
    others: dict[str, Suite] = {}
    for field in fields(Suite):
        value: Any = getattr(TINY, field.name)
        other: Any
        if isinstance(value, str):
            other = f"{value}x"
        elif field.name in {"policies", "cells"}:
            other = value[:1]
        else:
            other = value + 1
        others[field.name] = replace(TINY, **{field.name: other})
    cell = replace(TINY.cells[0], budget_ms=4.5)
    others["budget"] = replace(TINY, cells=(cell, TINY.cells[1]))
    digests = {suite.digest for suite in others.values()}
    assert len(digests) == len(others)
    assert TINY.digest not in digests
    assert TINY.digest == replace(TINY).digest


@pytest.mark.parametrize("name", list(SUITES))
def test_a_suite_names_what_there_is(name: str) -> None:
    """Policies are distinct competitors, cells have folders of their own."""
    suite = find_suite(name)
    specs = [parse_policy(policy) for policy in suite.policies]
    assert not any(map(is_oracle, specs))
    assert set(suite.policies) <= set(default_policies())
    assert len({cell.name for cell in suite.cells}) == len(suite.cells)


def test_unknown_suites_are_told_the_nearest() -> None:
    """One line, with the name that was meant."""
    with pytest.raises(InputError, match=r"did you mean quick\?"):
        find_suite("quik")


@pytest.mark.parametrize(
    ("policy", "message"),
    [("oracle", "expected a policy, got an oracle"), ("full", "got full twice")],
)
def test_what_cannot_be_submitted(policy: str, message: str) -> None:
    """An oracle competes with nobody, and the suite's own policies are there already."""
    with pytest.raises(InputError, match=message):
        run_suite(TINY, [parse_policy(policy)])


@pytest.fixture
def hostile(bad_policies: Path) -> PolicySpec:
    """Return a user's policy that raises in each of its replays."""
    return parse_policy(f"{bad_policies}:Raises")


@pytest.mark.slow
def test_a_hostile_policy_fails_alone_and_nothing_done_is_repeated(
    tmp_path: Path, hostile: PolicySpec, capsys: pytest.CaptureFixture[str]
) -> None:
    """The others have the scores that they have without it; a second start makes no replay."""
    replays: list[str] = []

    @contextmanager
    def watch(cell: str) -> Generator[Progress]:
        def told(done: int, total: int) -> None:
            replays.append(cell)

        yield told

    def run(*submitted: PolicySpec) -> SuiteResult:
        return run_suite(TINY, submitted, out=tmp_path, workers=2, watch=watch)

    alone = run()
    assert set(replays) == {cell.name for cell in TINY.cells}
    replays.clear()
    assert encode_record(run()) == encode_record(alone)
    assert replays == []
    assert "no run is repeated" in capsys.readouterr().err

    with_it = run(hostile)
    for cell, before in zip(with_it.cells, alone.cells, strict=True):
        standings = {one.label: one for one in cell.standings}
        failed = standings.pop(hostile.label)
        assert (failed.status, failed.rank) == ("failed", None)
        assert failed.reason is not None
        assert "lost <b>patience</b>" in failed.reason
        assert standings == {one.label: one for one in before.standings}
    assert with_it.leaderboard[-1].failed == len(TINY.cells)
    assert with_it.suite_hash == alone.suite_hash == TINY.digest


@pytest.mark.slow
def test_cells_say_who_keeps_the_budget() -> None:
    """Full detail takes half as much again as one budget; at the other nobody has to choose."""
    result = run_suite(TINY)
    tight, loose = result.cells
    of_full = {one.label: one for one in tight.standings}["full"]
    assert of_full.rank is None
    assert of_full.work_ms_p99 is not None
    assert of_full.work_ms_p99 > 1.5 * tight.budget_ms
    assert {one.label: one.rank for one in tight.standings}["static-screen"] == 1
    assert any("no policy has to choose" in warning for warning in loose.warnings)
    assert [leader.label for leader in result.leaderboard] == ["static-screen", "full"]
