"""An unattended run: on a software rasteriser, with parts that fail, and without time."""

import json
import os
import signal
import subprocess
import sys
import tarfile
import time
from pathlib import Path
from typing import Any

import pytest

from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_file import write_scene
from lodbench.render.unattended.campaign import Campaign, run_campaign
from lodbench.traces.logs.read_log import read_render_log

QUICK = ["--size", "64x36", "--calibration-frames", "24", "--repeats", "1", "--turns", "1"]


@pytest.fixture
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder in which temporary folders are made."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setenv("TMPDIR", str(folder))
    monkeypatch.setattr("tempfile.tempdir", str(folder))
    return folder


def result(out: Path) -> Any:
    """Return what a run left; nothing but its two files is there."""
    assert {path.name for path in out.iterdir()} <= {"result.json", "logs.tar.gz"}
    return json.loads((out / "result.json").read_text())


@pytest.mark.slow
@pytest.mark.usefixtures("egl")
def test_a_run_leaves_logs_that_can_be_fitted(
    balls: tuple[Scene, Geometry], scratch: Path, tmp_path: Path
) -> None:
    """Calibration, frames in flight and a policy under a budget that bites; no scratch is left."""
    scene, out = tmp_path / "balls.lodscene", tmp_path / "out"
    write_scene(scene, *balls)
    command = [sys.executable, "-m", "lodbench.render.unattended", "--out", str(out), *QUICK]
    command += ["--scenes", f"{scene}:walk", "--draws", "instanced", "--policies", "full"]
    command += ["--seconds", "0.02"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    found = result(out)
    assert found["schema"] == "lodbench.unattended/1"
    assert found["errors"] == []
    assert list(found["recordings"]) == ["balls-instanced-calibration", "balls-instanced-full-0"]
    calibration = found["recordings"]["balls-instanced-calibration"]
    assert calibration["frames"] == 24
    assert calibration["header"]["draws"] == "instanced"
    assert found["budget_ms"]["balls-instanced"] == calibration["frame_ms"][1]
    assert calibration["frame_ms"] == sorted(calibration["frame_ms"])
    flight = found["frames_in_flight"]["balls-instanced"]
    assert list(flight) == ["alone", "1", "2", "3", "4"]
    assert all(value > 0.0 for value in flight["4"].values())
    assert list(flight["4"]) == ["interval_ms", "lag_ms", "cpu_ms"]
    with tarfile.open(out / "logs.tar.gz") as tar:
        tar.extractall(tmp_path, filter="data")
    log = read_render_log(tmp_path / "logs" / "balls-instanced-calibration.parquet")
    assert len(log) == 24
    assert list(scratch.iterdir()) == []


def test_parts_that_fail_are_told_and_the_others_go_on(scratch: Path, tmp_path: Path) -> None:
    """A scene that is not there fails by name, each time, and a result is left all the same."""
    scenes = ("absent.lodscene:tour", "nothing.lodscene:tour")
    results = run_campaign(Campaign(scenes=scenes, draws=("each",)), tmp_path / "out")
    found = result(tmp_path / "out")
    assert found["errors"] == results.errors
    assert [error.split(":")[0] for error in found["errors"]] == [
        "absent-each-calibration",
        "nothing-each-calibration",
    ]
    assert "no such file" in found["errors"][0]
    assert found["recordings"] == {}
    assert list(scratch.iterdir()) == []


def test_without_time_nothing_is_begun(scratch: Path, tmp_path: Path) -> None:
    """What there was no time for is left out, and is no error."""
    results = run_campaign(Campaign(limit_s=0.0), tmp_path / "out")
    assert results.errors == []
    assert result(tmp_path / "out")["recordings"] == {}


def test_a_run_that_is_ended_leaves_a_whole_result(scratch: Path, tmp_path: Path) -> None:
    """SIGTERM, as a job scheduler sends it, ends what was started and removes scratch files."""
    command = [sys.executable, "-m", "lodbench.render.unattended", "--out", str(tmp_path / "out")]
    environment = os.environ | {"LODBENCH_CACHE": ""}  # so that the first part makes a scene
    with subprocess.Popen([*command, "--scenes", "city:tour"], env=environment) as run:
        until = time.monotonic() + 60.0
        names: list[str] = []
        # In the midst of a write it may leave a scratch folder, which the next write sweeps.
        while names != ["result.json"] and time.monotonic() < until:
            time.sleep(0.05)
            names = [path.name for path in (tmp_path / "out").glob("*")]
        run.send_signal(signal.SIGTERM)
    assert run.returncode == 128 + signal.SIGTERM
    assert result(tmp_path / "out")["errors"] == []
    assert list(scratch.iterdir()) == []
