"""The folder of results: whole or not at all, and never at the cost of somebody's files."""

from collections.abc import Callable
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from lodbench.analysis.study import comparison_folder as output
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import Compared
from lodbench.base.errors import InputError
from lodbench.base.files import whole_folder
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_file import write_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

SCREEN = "static-screen:first=0.5,bias=2"


@pytest.fixture(scope="module")
def results(small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile) -> Compared:
    """Return a comparison of two policies, one of whose labels no file system would like."""
    policies = [parse_policy(text) for text in ("full", SCREEN)]
    settings = CompareSettings(workers=1, seeds=2)
    replay = ReplayOptions(budget_ms=8.0)
    return compare(policies, small_scene, [turn_trace], machine, replay, settings)


def test_folder_holds_what_is_promised(results: Compared, tmp_path: Path) -> None:
    """Report, comparison, scene and a frame log a policy are written, nothing is left beside."""
    output.write_results(tmp_path / "run", results)
    files = sorted(p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("*") if p.is_file())
    assert files == [
        "run/comparison.json",
        "run/frames/full.parquet",
        "run/frames/static-screen_first=0.5,bias=2.parquet",
        "run/report.html",
        "run/runs.parquet",
        "run/scene.lodscene",
    ]


def test_results_are_read_back(results: Compared, tmp_path: Path) -> None:
    """What is read is what was written."""
    output.write_results(tmp_path / "run", results)
    read = output.read_results(tmp_path / "run")
    assert read.comparison == results.comparison
    assert {label: log.counts.tobytes() for label, log in read.logs.items()} == {
        label: log.counts.tobytes() for label, log in results.logs.items()
    }
    assert read.runs == results.runs
    assert read.scene is not None
    for label, log in results.logs.items():
        kept, levels = log.levels, read.logs[label].levels
        assert kept is not None
        assert levels is not None
        assert len(levels) == len(log)
        assert levels.node.tobytes() == kept.node.tobytes()
        assert levels.switches(read.scene).sum() == log["toggles"].sum()


def test_levels_of_another_scene_are_refused(
    results: Compared, tmp_path: Path, make_scene: Callable[..., Scene]
) -> None:
    """A scene beside the logs that has fewer nodes than they name is an error of the log's file."""
    output.write_results(tmp_path / "run", results)
    write_scene(tmp_path / "run" / "scene.lodscene", make_scene([(0.0, 0.0, 0.0)]), ())
    with pytest.raises(InputError, match=r"full\.parquet.*expected nodes and levels of by-hand"):
        output.read_results(tmp_path / "run")


def test_same_results_same_bytes(results: Compared, tmp_path: Path) -> None:
    """Two folders of one comparison are equal to the byte."""
    for name in ("a", "b"):
        output.write_results(tmp_path / name, results)
    for path in (tmp_path / "a").rglob("*"):
        if path.is_file():
            twin = tmp_path / "b" / path.relative_to(tmp_path / "a")
            assert path.read_bytes() == twin.read_bytes(), path.name


def test_every_replay_is_a_row(results: Compared, tmp_path: Path) -> None:
    """Two policies under two seeds are four rows, each with what its policy is judged by."""
    output.write_results(tmp_path / "run", results)
    rows = pq.read_table(tmp_path / "run" / "runs.parquet").to_pylist()
    assert sorted((row["policy"], row["seed"]) for row in rows) == [
        *(("full", 0), ("full", 1)),
        *((SCREEN, 0), (SCREEN, 1)),
    ]
    assert all(row["judged"] for row in rows)
    for policy in results.comparison.ok:
        work = [row["work_ms_mean"] for row in rows if row["policy"] == policy.label]
        assert sum(work) / 2 == pytest.approx(policy.value_of("work_ms_mean"), rel=1e-12)


def test_earlier_results_are_replaced(results: Compared, tmp_path: Path) -> None:
    """A folder that compare wrote gives way to the new one, with all its frame logs."""
    folder = tmp_path / "run"
    output.write_results(folder, results)
    stale = folder / "frames" / "gone.parquet"
    stale.write_bytes(b"")
    output.write_results(folder, results)
    assert not stale.exists()


@pytest.mark.parametrize("place", ["notes.txt", "frames/notes.txt"])
def test_other_files_are_never_lost(results: Compared, tmp_path: Path, place: str) -> None:
    """A folder that holds anything else is refused before and after the replays."""
    theirs = tmp_path / "run" / place
    theirs.parent.mkdir(parents=True)
    theirs.write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match=r"notes\.txt; name another"):
        output.check_target(tmp_path / "run")
    with pytest.raises(InputError, match=r"notes\.txt"):
        output.write_results(tmp_path / "run", results)
    assert theirs.read_text(encoding="utf-8") == "mine"


def test_file_is_no_folder(tmp_path: Path) -> None:
    """A file in the way is refused."""
    (tmp_path / "run").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="got a file"):
        output.check_target(tmp_path / "run")


def test_interrupted_write_leaves_nothing(
    results: Compared, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ctrl-C while writing keeps the earlier results and leaves no half-written folder."""
    output.write_results(tmp_path / "run", results)
    before = (tmp_path / "run" / "comparison.json").read_bytes()

    def interrupt(*_: object) -> str:
        raise KeyboardInterrupt

    monkeypatch.setattr(output, "render_report", interrupt)
    with pytest.raises(KeyboardInterrupt):
        output.write_results(tmp_path / "run", results)
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
    assert (tmp_path / "run" / "comparison.json").read_bytes() == before
    with pytest.raises(KeyboardInterrupt):
        output.write_results(tmp_path / "fresh", results)
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_failed_rename_brings_the_earlier_results_back(
    results: Compared, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without an exchange, if the new folder cannot be put in place, the old one is."""
    folder = tmp_path / "run"
    output.write_results(folder, results)
    rename = Path.rename

    def refuse(*_: Path) -> bool:
        return False

    def fail_for_new(self: Path, target: Path) -> Path:
        if self.name == "new":
            raise PermissionError(13, "no", str(target))
        return rename(self, target)

    monkeypatch.setattr(whole_folder, "exchange", refuse)
    monkeypatch.setattr(Path, "rename", fail_for_new)
    with pytest.raises(PermissionError):
        output.write_results(folder, results)
    assert (folder / "comparison.json").is_file()


def test_names_of_frame_logs_are_distinct() -> None:
    """Labels that become equal as file names, or differ by case only, get numbers.

    A label has the same file whoever lists the labels in whatever order: who writes goes by the
    order given, who reads by rank.
    """
    labels = ["a/b:C", "a_b_C", "A_B_c", "full"]
    names = output.frame_log_names(labels)
    assert names == {
        "A_B_c": "A_B_c.parquet",
        "a/b:C": "a_b_C-2.parquet",
        "a_b_C": "a_b_C-3.parquet",
        "full": "full.parquet",
    }
    assert output.frame_log_names(labels[::-1]) == names


def test_report_is_written_again(results: Compared, tmp_path: Path) -> None:
    """A lost report comes back the same from the data beside it."""
    folder = tmp_path / "run"
    output.write_results(folder, results)
    before = (folder / "report.html").read_bytes()
    (folder / "report.html").unlink()
    assert output.rewrite_report(folder) == folder / "report.html"
    assert (folder / "report.html").read_bytes() == before


def test_frame_log_of_another_run_is_refused(results: Compared, tmp_path: Path) -> None:
    """A frame log that is not of the comparison is named, not drawn."""
    folder = tmp_path / "run"
    output.write_results(folder, results)
    frames = folder / "frames"
    (frames / "full.parquet").write_bytes(
        (frames / "static-screen_first=0.5,bias=2.parquet").read_bytes()
    )
    with pytest.raises(InputError, match=r"frames of full.*got .* of static-screen"):
        output.rewrite_report(folder)


def test_missing_frame_log_is_refused(results: Compared, tmp_path: Path) -> None:
    """A folder without a frame log says which."""
    folder = tmp_path / "run"
    output.write_results(folder, results)
    (folder / "frames" / "full.parquet").unlink()
    with pytest.raises(InputError, match=r"full\.parquet"):
        output.rewrite_report(folder)


def test_what_cannot_be_written_is_refused_before_the_work(tmp_path: Path) -> None:
    """A new folder below a file can never be made, which is known before any replay."""
    (tmp_path / "file").write_text("", encoding="utf-8")
    with pytest.raises(InputError, match="file: expected a folder that can be written to"):
        output.check_target(tmp_path / "file" / "run")
