"""What a command keeps while it works, where it asks for its runs in rounds."""

import errno
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from lodbench.analysis.study.engine.task import Failure, Outcome
from lodbench.analysis.study.results.run_list import RunList
from lodbench.analysis.study.results.store import ResultStore
from lodbench.analysis.study.results.work_folder import WorkFolder, remove_work, work_path
from lodbench.analysis.study.score import Scored

MakeRuns = Callable[..., RunList]
STUDY = "f" * 32


@pytest.fixture
def rounds(make_runs: MakeRuns) -> tuple[RunList, RunList]:
    """Return two rounds of one study: three runs of one policy, then four of another."""
    first, second = make_runs(3, study=STUDY), make_runs(4, ("feedback",), study=STUDY)
    assert first.digest == second.digest == STUDY
    return first, second


def carry_out(
    work: WorkFolder,
    runs: RunList,
    make_outcome: Callable[..., Outcome],
    most: int = 99,
) -> tuple[dict[int, Scored | Failure], int]:
    """Carry out what is missing of a round, or so many of it; return its results, and how many."""
    results = work.begin(runs)
    missing = [at for at in range(len(runs)) if at not in results][:most]
    for at in missing:
        outcome = make_outcome(at)
        results[at] = outcome.failure or outcome.result
        work.add(at, outcome)
    work.flush()
    return results, len(missing)


def test_a_study_that_is_stopped_in_each_round_repeats_no_run(
    rounds: tuple[RunList, RunList], make_outcome: Callable[..., Outcome], tmp_path: Path
) -> None:
    """Stopped in the first round and in the second, it ends with what one that was not has."""
    whole = WorkFolder(tmp_path / "whole", STUDY)
    wanted = [carry_out(whole, runs, make_outcome)[0] for runs in rounds]
    target, carried = tmp_path / "run", 0
    for stops in ((2,), (99, 1), (99, 99)):
        work = WorkFolder(target, STUDY)
        for at, most in enumerate(stops):
            results, count = carry_out(work, rounds[at], make_outcome, most)
            carried += count
            if most == 99:
                assert results == wanted[at]
        assert work.durable == carried
        assert work.close() == carried
    assert carried == 7
    remove_work(target)
    assert not work_path(target).exists()


def test_rows_are_of_all_rounds(
    rounds: tuple[RunList, RunList], make_outcome: Callable[..., Outcome], tmp_path: Path
) -> None:
    """A store that is opened for one round counts the rows of the others, but gives its own."""
    for runs in rounds:
        with ResultStore.open(tmp_path / "run", runs) as store:
            for at in range(len(runs)):
                store.add(at, make_outcome(at))
    with ResultStore.open(tmp_path / "run", rounds[0]) as store:
        assert store.rows == 7
        assert sorted(at for at, _ in store.results()) == [0, 1, 2]
        assert store.missing == []


def test_runs_of_another_study_are_refused(
    make_runs: MakeRuns, make_outcome: Callable[..., Outcome], tmp_path: Path
) -> None:
    """A round has the name of its study, and a result needs a round."""
    work = WorkFolder(tmp_path / "run", STUDY)
    with pytest.raises(ValueError, match="expected runs of the study"):
        work.begin(make_runs(3))
    with pytest.raises(ValueError, match="expected a round"):
        work.add(0, make_outcome(0))


def test_another_study_takes_nothing_over(
    rounds: tuple[RunList, RunList], make_runs: MakeRuns,
    make_outcome: Callable[..., Outcome], tmp_path: Path,
) -> None:  # fmt: skip
    """The same runs of a study of another name are carried out again."""
    work = WorkFolder(tmp_path / "run", STUDY)
    carry_out(work, rounds[0], make_outcome)
    work.close()
    other = make_runs(3, study="0" * 32)
    assert WorkFolder(tmp_path / "run", "0" * 32).begin(other) == {}


def test_without_room_the_study_goes_on(
    rounds: tuple[RunList, RunList], make_outcome: Callable[..., Outcome],
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    """What cannot be kept is not called durable, and what was kept before it stays."""
    work = WorkFolder(tmp_path / "run", STUDY)
    carry_out(work, rounds[0], make_outcome)

    def refuse(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", refuse)
    results, count = carry_out(work, rounds[1], make_outcome)
    assert (len(results), count, work.durable) == (4, 4, 3)
    assert work.close() == 3
    monkeypatch.undo()
    assert len(WorkFolder(tmp_path / "run", STUDY).begin(rounds[0])) == 3


def test_a_study_has_the_hash_of_its_runs_unless_it_is_named(make_runs: MakeRuns) -> None:
    """Two lists of one name are one study whatever they hold; of none, only if they are equal."""
    assert make_runs(3).digest == make_runs(3).digest != make_runs(4).digest
    assert make_runs(3, study=STUDY).digest == make_runs(4, study=STUDY).digest == STUDY
