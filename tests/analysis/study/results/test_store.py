"""Folders of results: they go on where they stopped, and end with the same bytes."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.study.engine.task import Outcome
from lodbench.analysis.study.results import parts
from lodbench.analysis.study.results import store as module
from lodbench.analysis.study.results.manifest import read_manifest
from lodbench.analysis.study.results.run_list import RunList
from lodbench.analysis.study.results.store import ResultStore, read_results
from lodbench.base.errors import InputError

MakeRuns = Callable[..., RunList]
MakeOutcome = Callable[..., Outcome]


def files(folder: Path) -> dict[str, bytes]:
    """Return every file of a folder, hidden ones too."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def fill(
    folder: Path, runs: RunList, make_outcome: MakeOutcome, *, at_most: int | None = None
) -> list[int]:
    """Carry out what is missing, or some of it in a scrambled order; return what was."""
    with ResultStore.open(folder, runs) as store:
        todo = store.missing
        if at_most is not None:
            todo = list(np.random.default_rng(0).permutation(todo)[:at_most])
        for at in todo:
            store.add(int(at), make_outcome(int(at)))
        if at_most is None:
            store.finish()
    return todo


@pytest.fixture
def undisturbed(make_runs: MakeRuns, make_outcome: MakeOutcome, tmp_path: Path) -> Path:
    """Return the folder of a study of 40 runs that was done in one go."""
    fill(tmp_path / "undisturbed", make_runs(40), make_outcome)
    return tmp_path / "undisturbed"


def test_a_resumed_study_ends_with_the_same_bytes(
    make_runs: MakeRuns, make_outcome: MakeOutcome, undisturbed: Path, tmp_path: Path
) -> None:
    """Stopped twice in any order, each run is carried out once, and no other file is left."""
    folder = tmp_path / "study"
    done = [*fill(folder, make_runs(40), make_outcome, at_most=9)]
    done += fill(folder, make_runs(40), make_outcome, at_most=20)
    done += fill(folder, make_runs(40), make_outcome)
    assert sorted(done) == list(range(40))
    assert files(folder) == files(undisturbed)
    assert list(files(folder)) == ["manifest.json", "parts/part-00000.parquet"]


def test_rows_stand_in_the_order_of_the_study(make_runs: MakeRuns, undisturbed: Path) -> None:
    """The rows of a finished study are its runs, one each."""
    assert read_results(undisturbed)["digest"].to_pylist() == list(make_runs(40).digests)


def test_a_finished_study_has_nothing_to_do(
    make_runs: MakeRuns, make_outcome: MakeOutcome, undisturbed: Path
) -> None:
    """It is found whole, and not a byte of it changes."""
    before = files(undisturbed)
    assert fill(undisturbed, make_runs(40), make_outcome) == []
    assert files(undisturbed) == before


def test_long_studies_make_parts_of_a_fixed_size(
    make_runs: MakeRuns,
    make_outcome: MakeOutcome,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The last part has what is left."""
    monkeypatch.setattr(module, "ROWS", 15)
    fill(tmp_path / "a", make_runs(40), make_outcome)
    manifest = read_manifest(tmp_path / "a")
    assert manifest is not None
    assert manifest.complete
    assert [part.rows for part in manifest.parts] == [15, 15, 10]


def test_many_commits_make_few_files(
    make_runs: MakeRuns,
    make_outcome: MakeOutcome,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of 13 commits of a result each, with three alike made one, are left: 9, 3 and 1 rows."""
    monkeypatch.setattr(parts, "FAN", 3)
    runs = make_runs(13)
    with ResultStore.open(tmp_path / "a", runs) as store:
        for at in range(13):
            store.add(at, make_outcome(at))
            store.flush()
    manifest = read_manifest(tmp_path / "a")
    assert manifest is not None
    assert [part.rows for part in manifest.parts] == [9, 3, 1]
    assert len(files(tmp_path / "a")) == 4
    assert {*read_results(tmp_path / "a")["digest"].to_pylist()} == {*runs.digests}


def test_what_was_flushed_is_there_after_a_crash(
    make_runs: MakeRuns, make_outcome: MakeOutcome, tmp_path: Path
) -> None:
    """A store that nobody closes has lost nothing of what it called durable."""
    runs = make_runs(10)
    store = ResultStore.open(tmp_path / "a", runs)
    for at in range(4):
        store.add(at, make_outcome(at))
    store.flush()
    assert store.durable == 4
    assert ResultStore.open(tmp_path / "a", runs).missing == [4, 5, 6, 7, 8, 9]


def test_a_study_that_stops_leaves_out_what_lies_behind_a_failure(
    make_runs: MakeRuns, make_outcome: MakeOutcome, tmp_path: Path
) -> None:
    """Run 6 of the first policy fails: 7 to 9 are not wanted, and a result of 8 does not count."""
    runs = make_runs(10, ("full", "oracle"), stop=True)
    with ResultStore.open(tmp_path / "a", runs) as store:
        for at in (8, 6):
            store.add(at, make_outcome(at))
        assert store.missing == [0, 1, 2, 3, 4, 5, *range(10, 20)]
        for at in (*range(6), *range(10, 14)):
            store.add(at, make_outcome(at))
        assert store.missing == []  # 13 fails too
        store.finish()
    wanted = [*range(7), *range(10, 14)]
    digests = read_results(tmp_path / "a")["digest"].to_pylist()
    assert digests == [runs.digests[at] for at in wanted]


def test_an_unfinished_study_is_not_called_finished(make_runs: MakeRuns, tmp_path: Path) -> None:
    """A caller that forgets a run is told."""
    with (
        ResultStore.open(tmp_path / "a", make_runs(2)) as store,
        pytest.raises(ValueError, match="2 runs of the study are not carried out"),
    ):
        store.finish()


def test_another_study_is_refused_or_replaced(
    make_runs: MakeRuns, make_outcome: MakeOutcome, undisturbed: Path, tmp_path: Path
) -> None:
    """Without leave it stays as it is; with leave nothing of it remains."""
    before = files(undisturbed)
    with pytest.raises(InputError, match="got another study's"):
        ResultStore.open(undisturbed, make_runs(3))
    assert files(undisturbed) == before
    with ResultStore.open(undisturbed, make_runs(3), replaces=True) as store:
        for at in store.missing:
            store.add(at, make_outcome(at))
        store.finish()
    fill(tmp_path / "fresh", make_runs(3), make_outcome)
    assert files(undisturbed) == files(tmp_path / "fresh")


def flip(path: Path, at: int) -> None:
    """Change one bit of a file."""
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)


def truncate(path: Path) -> None:
    """Cut a file in half, as one that was torn."""
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


DAMAGE: dict[str, Callable[[Path], Any]] = {
    "gone": Path.unlink,
    "torn": truncate,
    "empty": lambda path: path.write_bytes(b""),
    "bit": lambda path: flip(path, path.stat().st_size // 2),
    "other": lambda path: path.write_bytes(b"{}"),
}


@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_part_is_made_anew(
    make_runs: MakeRuns,
    make_outcome: MakeOutcome,
    undisturbed: Path,
    capsys: pytest.CaptureFixture[str],
    damage: str,
) -> None:
    """Its runs are repeated, which a line says, and the study ends with the same bytes."""
    before = files(undisturbed)
    DAMAGE[damage](undisturbed / "parts" / "part-00000.parquet")
    with pytest.raises(InputError, match=r"part-00000\.parquet: expected the part that was"):
        read_results(undisturbed)
    assert fill(undisturbed, make_runs(40), make_outcome) == list(range(40))
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith("its 40 runs are repeated")
    assert files(undisturbed) == before


def test_only_the_runs_of_a_damaged_part_are_repeated(
    make_runs: MakeRuns, make_outcome: MakeOutcome, undisturbed: Path, tmp_path: Path
) -> None:
    """Those of other parts are kept."""
    folder = tmp_path / "study"
    first = fill(folder, make_runs(40), make_outcome, at_most=9)
    fill(folder, make_runs(40), make_outcome, at_most=20)
    flip(folder / "parts" / "early-00000.parquet", 100)
    repeated = fill(folder, make_runs(40), make_outcome)
    assert len(repeated) == 40 - 20
    assert set(first) <= set(repeated)
    assert files(folder) == files(undisturbed)


@pytest.mark.parametrize("damage", DAMAGE)
def test_with_a_damaged_manifest_a_study_begins_anew(
    make_runs: MakeRuns,
    make_outcome: MakeOutcome,
    undisturbed: Path,
    capsys: pytest.CaptureFixture[str],
    damage: str,
) -> None:
    """One line says so; where it is gone there is nothing to say."""
    before = files(undisturbed)
    DAMAGE[damage](undisturbed / "manifest.json")
    assert fill(undisturbed, make_runs(40), make_outcome) == list(range(40))
    lines = capsys.readouterr().err.splitlines()
    assert [line.endswith("; this study begins anew") for line in lines] == [True] * (
        damage != "gone"
    )
    assert files(undisturbed) == before


def test_any_bit_of_the_manifest_matters(undisturbed: Path) -> None:
    """A manifest with any one bit changed is refused, though most stay JSON of its form."""
    path = undisturbed / "manifest.json"
    whole = path.read_bytes()
    for at in range(0, len(whole), 3):
        flip(path, at)
        with pytest.raises(InputError):
            read_manifest(undisturbed)
        path.write_bytes(whole)


def test_results_of_a_later_version_are_not_lost(make_runs: MakeRuns, undisturbed: Path) -> None:
    """What is whole but of another version is refused, not taken for damaged."""
    path = undisturbed / "manifest.json"
    path.write_bytes(path.read_bytes().replace(b"lodbench.study/2", b"lodbench.study/1"))
    before = files(undisturbed)
    with pytest.raises(InputError, match="study/2"):
        ResultStore.open(undisturbed, make_runs(40))
    assert files(undisturbed) == before


def test_files_that_are_not_listed_are_swept_and_others_are_not(
    make_runs: MakeRuns, make_outcome: MakeOutcome, undisturbed: Path
) -> None:
    """What a killed process left goes; what somebody put there stays."""
    (undisturbed / "parts" / "early-00007.parquet").write_bytes(b"x")
    (undisturbed / "parts" / "notes.txt").write_bytes(b"mine")
    (undisturbed / "frames").mkdir()
    (undisturbed / "frames" / "0123.parquet").write_bytes(b"x")
    fill(undisturbed, make_runs(40), make_outcome)
    assert list(files(undisturbed)) == [
        "manifest.json",
        "parts/notes.txt",
        "parts/part-00000.parquet",
    ]


def test_frame_logs_are_kept_beside_the_parts(
    make_runs: MakeRuns, make_outcome: MakeOutcome, make_log: Callable[..., Any], tmp_path: Path
) -> None:
    """Results come back with theirs; of one whose log is damaged the run is repeated."""
    runs = make_runs(3, keeps_log=True)
    logs = [make_log([10.0, 20.0 + at]) for at in range(3)]
    with ResultStore.open(tmp_path / "a", runs) as store:
        for at in range(3):
            store.add(at, make_outcome(at, log=logs[at]))
        store.finish()
        found = dict(store.results())
    for at, log in enumerate(logs):
        result: Any = found[at]
        assert result.log.header == log.header
        assert result.log.times_ns.tobytes() == log.times_ns.tobytes()
        assert result.log.counts.tobytes() == log.counts.tobytes()
    before = files(tmp_path / "a")
    flip(tmp_path / "a" / "frames" / f"{runs.digests[1]}.parquet", 50)
    with ResultStore.open(tmp_path / "a", runs) as store:
        assert store.missing == [1]
        store.add(1, make_outcome(1, log=logs[1]))
        store.finish()
    assert files(tmp_path / "a") == before


def test_a_folder_that_vanishes_is_told_where_results_are_added(
    make_runs: MakeRuns, make_outcome: MakeOutcome, tmp_path: Path
) -> None:
    """The error of the thread that writes reaches who adds, in one line."""
    import shutil

    store = ResultStore.open(tmp_path / "a", make_runs(3))
    shutil.rmtree(tmp_path / "a")
    store.add(0, make_outcome(0))
    with pytest.raises(InputError, match="expected a path that can be written"):
        store.flush()
    with pytest.raises(InputError, match="expected a path that can be written"):
        store.add(1, make_outcome(1))
