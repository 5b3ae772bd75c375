"""Comparisons that go on where they were stopped, and that are not done again."""

import errno
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study import compare as comparing
from lodbench.analysis.study import run
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.comparison_target import claimed_target
from lodbench.base.errors import InputError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.policy_spec import PolicySpec
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

POLICIES = ("full", "static-screen:bias=1", "feedback:target=0.9")
FIRST = len(POLICIES)  # on the path, of policies that are not tuned
RUNS = len(POLICIES) * 4  # then under two draws, and for the log


class Command:
    """`compare --out` in the small world, so that a test names only what it is about."""

    def __init__(self, scene: Scene, trace: CameraTrace, hardware: HardwareProfile) -> None:
        self.scene, self.trace, self.hardware = scene, trace, hardware

    def __call__(
        self,
        out: Path,
        *,
        policies: list[PolicySpec] | None = None,
        stop_after: int | None = None,
        seed: int = 0,
    ) -> Comparison:
        """Compare; with `stop_after` as if Ctrl-C came after so many results."""
        results = 0

        def progress(_done: int, _total: int) -> None:
            nonlocal results
            results += 1
            if results == stop_after:
                raise KeyboardInterrupt

        with claimed_target(out) as target:
            compared = compare(
                policies or [parse_policy(name) for name in POLICIES],
                self.scene,
                [self.trace],
                self.hardware,
                ReplayOptions(budget_ms=8.0, seed=seed),
                CompareSettings(workers=1, draws=2, seeds=1, warmup_s=0.2),
                progress=progress,
                target=target,
            )
            assert target is not None
            target.write(compared)
        return compared.comparison


@pytest.fixture
def command(
    small_scene: Scene, turn_trace: CameraTrace, fitted_machine: HardwareProfile
) -> Command:
    """Return the command in the small world."""
    return Command(small_scene, turn_trace.stretch(0.9, 1.4), fitted_machine)


def promised(folder: Path) -> dict[str, bytes]:
    """Return the files of a folder, hidden ones too, but for the one that has times in it."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.name != "run-info.json"
    }


def info(folder: Path) -> dict[str, Any]:
    """Return what ``run-info.json`` says."""
    return json.loads((folder / "run-info.json").read_text(encoding="utf-8"))


def runs_of(folder: Path) -> int:
    """Return how many runs were carried out for a folder."""
    return sum(policy["runs"] for policy in info(folder)["policies"].values())


def test_a_stopped_comparison_goes_on(
    command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A line says how; no run is repeated; the bytes are the same, and nothing else is left."""
    command(tmp_path / "whole")
    out = tmp_path / "study" / "run"
    with pytest.raises(KeyboardInterrupt):
        command(out, stop_after=2)
    line = "2 runs are kept; run the same command again to go on\n"
    assert capsys.readouterr().err == line
    assert not out.exists()
    command(out)
    assert (runs_of(out), info(out)["starts"]) == (RUNS, 2)
    assert promised(out) == promised(tmp_path / "whole")
    assert [path.name for path in out.parent.iterdir()] == ["run"]


def test_a_comparison_that_is_there_is_not_repeated(
    command: Command, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same command changes no byte, and returns what is in the folder."""
    out = tmp_path / "run"
    first = command(out)
    before, written = promised(out), info(out)
    assert command(out, stop_after=1) == first
    assert "holds this comparison: no run is repeated" in capsys.readouterr().err
    assert (promised(out), info(out)) == (before, written)
    assert runs_of(out) == RUNS


def test_a_comparison_that_is_stopped_in_every_round_repeats_no_run(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Stopped before its knob is known, while it is sought, and after: each run is made once.

    What is asked in a later round depends on the results of earlier ones, which the next start
    reads from what was kept.
    """
    monkeypatch.setattr(comparing, "VARIATIONS", 2)
    policies = [parse_policy("full"), parse_policy("static-screen")]
    whole, out = tmp_path / "whole", tmp_path / "run"
    command(whole, policies=policies)
    runs, starts = runs_of(whole), 0
    for stop_after in (1, 14, 3):
        with pytest.raises(KeyboardInterrupt):
            command(out, policies=policies, stop_after=stop_after)
        starts += 1
    command(out, policies=policies)
    assert (runs_of(out), info(out)["starts"]) == (runs, starts + 1)
    assert promised(out) == promised(whole)


def change_report(out: Path) -> None:
    """Add to the page."""
    with (out / "report.html").open("a", encoding="utf-8") as page:
        page.write(" ")


def remove_log(out: Path) -> None:
    """Lose a frame log."""
    (out / "frames" / "full.parquet").unlink()


def forget_study(out: Path) -> None:
    """Lose what says which comparison it is."""
    (out / "study.json").write_text("{", encoding="utf-8")


@pytest.mark.slow
@pytest.mark.parametrize("damage", [change_report, remove_log, forget_study])
def test_a_comparison_that_is_not_whole_is_done_again(
    command: Command, tmp_path: Path, damage: Callable[[Path], None]
) -> None:
    """What differs by a byte from what was written is replaced by it."""
    out = tmp_path / "run"
    command(out)
    before = promised(out)
    damage(out)
    command(out)
    assert promised(out) == before


@pytest.mark.slow
def test_another_comparison_replaces_what_was_kept(command: Command, tmp_path: Path) -> None:
    """It takes over no run of the other's, and leaves nothing behind."""
    out = tmp_path / "run"
    with pytest.raises(KeyboardInterrupt):
        command(out, stop_after=2)
    command(out, seed=1)
    assert runs_of(out) == RUNS
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


@pytest.mark.slow
def test_the_earlier_result_stays_until_the_new_one_is_there(
    command: Command, tmp_path: Path
) -> None:
    """A comparison that is stopped touches no byte of the folder."""
    out = tmp_path / "run"
    command(out)
    before = promised(out)
    with pytest.raises(KeyboardInterrupt):
        command(out, seed=1, stop_after=2)
    assert promised(out) == before


def test_a_mistake_loses_no_work(command: Command, tmp_path: Path) -> None:
    """A command that is refused before its runs leaves those of the one before."""
    out = tmp_path / "run"
    with pytest.raises(KeyboardInterrupt):
        command(out, stop_after=2)
    with pytest.raises(InputError, match="full"):
        command(out, policies=[parse_policy("full")] * 2)
    command(out)
    assert runs_of(out) == RUNS


def test_a_policy_without_content_is_compared_all_the_same(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a class typed into a prompt no hash is known: nothing is kept, and nothing used again."""

    def refuse(_: PolicySpec) -> str:
        raise TypeError("no content to hash")

    monkeypatch.setattr(run, "policy_hash", refuse)
    monkeypatch.setattr(comparing, "policy_hash", refuse)
    out = tmp_path / "run"
    assert command(out, policies=[parse_policy("full")]).ok
    assert not (out / "study.json").exists()
    assert not (out / "runs.parquet").exists()
    assert [path.name for path in tmp_path.iterdir()] == ["run"]


def test_a_disk_that_is_full_does_not_stop_the_study(
    command: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Runs that cannot be kept count all the same; that the result cannot be written is told."""
    fsync = os.fsync

    def refuse(handle: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", refuse)
    with pytest.raises(InputError, match="No space left"):
        command(tmp_path / "run")
    monkeypatch.setattr(os, "fsync", fsync)
    assert command(tmp_path / "run").ok
    assert [path.name for path in tmp_path.iterdir()] == ["run"]
