"""Experiments: trials are measured once, claims say what they must, the page shows all of them."""

import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any, Self

import pytest

from lodbench.analysis.reproduce import reproduce as module
from lodbench.analysis.reproduce.experiment import (
    Chart,
    Claim,
    Constant,
    Experiment,
    Findings,
    Line,
    error_pct,
    not_reproduced,
    verdict_of,
)
from lodbench.analysis.reproduce.page import page_of, write_page
from lodbench.analysis.reproduce.registry import ALL, PAPERS, find_experiments
from lodbench.analysis.reproduce.reproduce import reproduce
from lodbench.analysis.reproduce.trial import Numbers, Trial, trial
from lodbench.analysis.study.engine.task import Failure, Outcome
from lodbench.base.errors import InputError, LodbenchError

MEASURED: list[float] = []


def double(*, number: float, beat: Any) -> Numbers:
    """Return twice a number, and remember that it was asked."""
    MEASURED.append(number)
    return {"twice": 2.0 * number}


class _Inline:
    """Carries trials out in this process, so that the test sees which of them were."""

    def __init__(self, *_: Any, **__: Any) -> None:
        pass

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def run(self, tasks: Sequence[Trial]) -> Iterator[Outcome]:
        for index, task in enumerate(tasks):
            if dict(task.arguments)["number"] == -1.0:
                yield Outcome(index, None, Failure("failed", "ValueError: negative"))
            else:
                yield Outcome(index, task({}, lambda _: None))


@pytest.fixture(autouse=True)
def inline(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trials of this module's function, here."""
    MEASURED.clear()
    toy = ModuleType("lodbench.analysis.reproduce.toy")
    vars(toy)["double"] = double
    monkeypatch.setitem(sys.modules, toy.__name__, toy)
    monkeypatch.setattr(module, "open_engine", _Inline)


def _trials(reduced: bool) -> list[Trial]:
    numbers = (1.0,) if reduced else (1.0, 2.0)
    return [trial(f"at {number:g}", "toy:double", {"number": number}) for number in numbers]


def _judge(numbers: Mapping[str, Numbers], reduced: bool) -> Findings:
    ours = numbers["at 1"]["twice"]
    verdict = verdict_of(ours == 2.0, "it is not")
    line = Line("here", [1.0, 2.0], [ours, 4.0])
    chart = Chart(name="twice", caption="Twice is more.", x="n", y="twice | n", lines=(line,))
    claim = Claim("one and one", "2", f"{ours:g}", "none", verdict)
    return Findings((claim,), (chart,), (f"{len(numbers)} trials",))


TOY = Experiment(
    id="toy/double",
    title="doubling",
    setting="Numbers.",
    constants={"factor": Constant("2", "printed", "section 1")},
    trials=_trials,
    judge=_judge,
)


def test_trials_are_measured_once_and_a_changed_one_again(tmp_path: Path) -> None:
    """A folder keeps numbers by content: the same command measures nothing, more size the rest."""
    first = reproduce([TOY], reduced=True, out=tmp_path)
    assert MEASURED == [1.0]
    assert reproduce([TOY], reduced=True, out=tmp_path) == first
    assert MEASURED == [1.0]
    reproduce([TOY], out=tmp_path)
    assert MEASURED == [1.0, 2.0]


def test_a_damaged_file_of_numbers_is_measured_again(tmp_path: Path) -> None:
    """What a killed process or a full disk left counts as nothing."""
    reproduce([TOY], reduced=True, out=tmp_path)
    (kept,) = (tmp_path / "trials").iterdir()
    kept.write_bytes(b'{"twice": ')
    result = reproduce([TOY], reduced=True, out=tmp_path)
    assert MEASURED == [1.0, 1.0]
    assert [entry.ours for entry in result.entries] == ["2"]


def test_a_failed_trial_ends_the_command_with_its_reason() -> None:
    """Nothing is judged on numbers that are missing."""

    def trials(_reduced: bool) -> list[Trial]:
        return [trial("at 1", "toy:double", {"number": -1.0})]

    with pytest.raises(LodbenchError, match=r"toy:double at 1: .*ValueError: negative"):
        reproduce([replace(TOY, trials=trials)])


def test_the_record_has_what_the_design_says() -> None:
    """Every claim stands with the origin of each constant of its experiment."""
    record = json.loads(json.dumps(reproduce([TOY], command="lodbench reproduce").to_json()))
    assert record["schema"] == "lodbench.reproduce/2"
    assert record["experiments"] == [
        {
            "id": "toy/double",
            "claim": "one and one",
            "paper": "2",
            "ours": "2",
            "tolerance": "none",
            "verdict": "reproduced",
            "constants": {"factor": "printed"},
        }
    ]


def test_the_page_shows_claims_constants_notes_and_pictures(tmp_path: Path) -> None:
    """The same result gives the same bytes, and every picture that the page names is there."""
    result = reproduce([TOY])
    write_page(result, tmp_path / "page.md")
    picture = tmp_path / "reproduction" / "toy-double-twice.svg"
    first = picture.read_bytes()
    assert b"twice | n" in first
    write_page(result, tmp_path / "page.md")
    assert picture.read_bytes() == first
    text = (tmp_path / "page.md").read_text()
    assert text == page_of(result)
    for part in ("| factor | 2 | printed | section 1 |", "2 trials", "reproduction/toy-double-"):
        assert part in text


def test_a_negative_verdict_needs_its_reason() -> None:
    """`not reproduced` alone would say nothing."""
    for verdict in ("not reproduced", "close"):
        with pytest.raises(ValueError, match="expected a verdict"):
            Claim("it", "1", "2", "", verdict)
    assert Claim("it", "1", "2", "", not_reproduced("twice as much")).verdict.endswith("much")
    assert verdict_of(holds=False, why_not="too small", direction=True) == "in direction"
    assert error_pct(110.0, 100.0) == pytest.approx(10.0)


def test_papers_and_experiments_are_found_by_name() -> None:
    """A typing error is answered with the nearest name, before any work."""
    everything = find_experiments(ALL)
    assert len({one.id for one in everything}) == len(everything)
    assert everything == tuple(one for paper in PAPERS for one in find_experiments(paper))
    for one in everything:
        assert find_experiments(one.id) == (one,)
    with pytest.raises(InputError, match="did you mean zach"):
        find_experiments("zahc")
