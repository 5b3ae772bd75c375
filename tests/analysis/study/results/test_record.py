"""Rows of results: what they say of a run, and that nothing of its scores is lost in them."""

import json
import math
import struct
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.metrics.steps import Step
from lodbench.analysis.study.engine.task import Failure
from lodbench.analysis.study.results.parts import read_part, write_part
from lodbench.analysis.study.results.record import COLUMNS, Entry, decode, encode
from lodbench.analysis.study.results.run_list import RunList
from lodbench.analysis.study.score import Scored
from lodbench.base.errors import InputError

MakeRuns = Callable[..., RunList]
ODD = (0.0, -0.0, math.inf, -math.inf, 5e-324, 0.1 + 0.2, 1.7976931348623157e308)


def bits(value: float | None) -> bytes | None:
    """Return the eight bytes of a number."""
    return None if value is None else struct.pack("<d", value)


def nan(payload: int) -> float:
    """Return a NaN that is told from others by its payload."""
    return float(np.array([0x7FF8_0000_0000_0000 | payload], np.uint64).view(np.float64)[0])


def content(result: Scored | Failure) -> Any:
    """Return all of a result in a form whose equality is that of the bits."""
    if isinstance(result, Failure):
        return result
    values = {name: bits(value) for name, value in result.values.items()}
    steps = [
        [bits(item) if isinstance(item, float) else item for item in vars_of(step)]
        for step in result.steps
    ]
    return values, steps, result.frames


def vars_of(step: Step) -> list[Any]:
    """Return the fields of a step."""
    return [getattr(step, name) for name in Step.__slots__]


def odd_scores(make_scored: Callable[..., Scored]) -> Scored:
    """Return scores of the numbers that are lost first: signs of zero, NaN, the least, the most."""
    ids = [metric.id for metric in METRICS]
    numbers = [*ODD, nan(1), nan(2), None]
    values = {name: numbers[i % len(numbers)] for i, name in enumerate(ids)}
    steps = (Step(0, -0.0, math.inf, 5e-324, 0.1, settled=False, overshoot_ratio=nan(4)),)
    return make_scored(1, values=values, steps=steps)


def test_what_is_read_is_what_was_written_bit_for_bit(
    make_runs: MakeRuns, make_scored: Callable[..., Scored], tmp_path: Any
) -> None:
    """Scores, failures and steps come back from a file as they were, in their order."""
    results: list[Scored | Failure] = [
        odd_scores(make_scored),
        make_scored(2),
        Failure("failed", "a\nline – ü", 0),
        Failure("failed", "before the first frame", None),
        Failure("not-applicable", "needs a tree"),
        make_scored(3, steps=()),
    ]
    runs = make_runs(len(results))
    entries = [Entry(at, result) for at, result in enumerate(results)]
    (tmp_path / "parts").mkdir()
    part = write_part(tmp_path, "early", 0, encode(runs, entries))
    found = list(decode(read_part(tmp_path, part)))
    assert [digest for digest, _ in found] == list(runs.digests)
    assert [content(result) for _, result in found] == [content(result) for result in results]


def test_rows_say_what_was_run(make_runs: MakeRuns, make_scored: Callable[..., Scored]) -> None:
    """A row has names and hashes, the policy with its parameters, and all options as JSON."""
    runs = make_runs(2, ("static-screen:bias=2",))
    (row,) = encode(runs, [Entry(1, make_scored(4))]).to_pylist()
    assert {name: row[name] for name in list(COLUMNS)[:13]} == {
        "digest": runs.runs[1].digest,
        "policy": "static-screen:bias=2",
        "policy_name": "static-screen",
        "params": '{"bias":2.0}',
        "scene": "plaza",
        "scene_hash": "a1",
        "trace": "tour",
        "trace_hash": "b2",
        "hardware": "desktop",
        "hardware_hash": "c3",
        "budget_ms": 8.0,
        "seed": 1,
        "draw": None,
    }
    options = json.loads(row["options"])
    assert (options["seed"], options["warmup_s"], options["faults"]["missing"]) == (1, 2.0, 0.0)
    assert options["faults"]["saturated_ms"] == "inf"  # JSON has no number for it
    assert (row["status"], row["reason"], row["frame"], row["frames"]) == ("ok", None, None, 34)


def test_axes_are_columns_of_one_kind(
    make_runs: MakeRuns, make_scored: Callable[..., Scored]
) -> None:
    """Whole numbers stay whole, mixed with others they are real, and mixed kinds are texts."""
    axes: dict[str, Any] = {
        "bias": [1, 2],
        "first": np.array([1, 0.5]),
        "display": ["vsync", None],
        "shadows": [True, False],
        "mixed": [1, "off"],
    }
    table = encode(make_runs(2, axes=axes), [Entry(at, make_scored(at)) for at in (0, 1)])
    wanted: dict[str, Any] = {
        "bias": (pa.int64(), [1, 2]),
        "first": (pa.float64(), [1.0, 0.5]),
        "display": (pa.string(), ["vsync", None]),
        "shadows": (pa.bool_(), [True, False]),
        "mixed": (pa.string(), ["1", "off"]),
    }
    for name, (kind, values) in wanted.items():
        column: Any = table[name]
        assert (column.type, column.to_pylist()) == (kind, values)


@pytest.mark.parametrize("name", ["seed", "work_ms_p95", "steps"])
def test_an_axis_cannot_hide_another_column(make_runs: MakeRuns, name: str) -> None:
    """Two columns of one name could not be told apart."""
    with pytest.raises(ValueError, match=f"axis {name}: results have a column of that name"):
        make_runs(1, axes={name: [1]})


def test_a_study_is_known_by_all_that_its_rows_say(make_runs: MakeRuns) -> None:
    """Other runs, another order, other names or axes make another study; the same, the same."""
    runs = make_runs(2)
    others = [
        make_runs(3),
        make_runs(2, axes={"x": [1, 2]}),
        make_runs(2, stop=True),
        RunList(runs.runs[::-1], runs.names),
        RunList(runs.runs, {**runs.names, "a1": "other"}),
    ]
    assert len({runs.digest, *(other.digest for other in others)}) == 1 + len(others)
    assert make_runs(2).digest == runs.digest


def test_a_run_twice_is_refused(make_runs: MakeRuns) -> None:
    """Two rows of one run would count it double."""
    runs = make_runs(2)
    with pytest.raises(InputError, match="expected each run once, got 1 again"):
        RunList((*runs.runs, runs.runs[0]), runs.names)


def test_seeds_of_any_size_are_kept(
    make_runs: MakeRuns, make_scored: Callable[..., Scored]
) -> None:
    """A seed beyond 63 bits is whole in the options, and its column is empty."""
    runs = make_runs(1)
    large = replace(runs.runs[0], options=replace(runs.runs[0].options, seed=10**30))
    (row,) = encode(RunList((large,), runs.names), [Entry(0, make_scored(0))]).to_pylist()
    assert row["seed"] is None
    assert json.loads(row["options"])["seed"] == 10**30


def test_text_that_no_file_can_hold_is_written_all_the_same(make_runs: MakeRuns) -> None:
    """What a policy raises may have half a character in it."""
    row = encode(make_runs(1), [Entry(0, Failure("failed", "half \ud83d", 3))]).to_pylist()[0]
    assert row["reason"] == "half \\ud83d"


def test_no_rows_have_the_columns_all_the_same(make_runs: MakeRuns, tmp_path: Any) -> None:
    """A study without runs is a table that can be read."""
    table = encode(make_runs(0), [])
    parquet.write_table(table, tmp_path / "empty.parquet")
    assert list(decode(parquet.read_table(tmp_path / "empty.parquet"))) == []
