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
from lodbench.render.unattended import campaign
from lodbench.render.unattended.campaign import Campaign, run_campaign
from lodbench.render.unattended.child_process import ChildError
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
    """Calibration, a policy under a budget that bites, and frames in flight; no scratch is left."""
    names = [str(tmp_path / name) for name in ("balls.lodscene", "others.lodscene")]
    for name in names:
        write_scene(Path(name), *balls)
    out = tmp_path / "out"
    command = [sys.executable, "-m", "lodbench.render.unattended", "--out", str(out), *QUICK]
    command += ["--calibration", f"{names[0]}:walk", "--scenes", f"{names[1]}:walk"]
    command += ["--draws", "instanced", "--policies", "full", "--seconds", "0.02"]
    command += ["--deepest", "1"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    found = result(out)
    assert found["schema"] == "lodbench.unattended/1"
    assert found["errors"] == []
    assert list(found["recordings"]) == [
        "balls-instanced-calibration",
        *(f"others-instanced-{part}" for part in ("load", "full-0", "flight-1")),
    ]
    calibration = found["recordings"]["balls-instanced-calibration"]
    assert calibration["frames"] == 24
    assert calibration["header"]["order"] == "shuffled"
    assert calibration["header"]["draws"] == "instanced"
    load = found["recordings"]["others-instanced-load"]
    assert found["budget_ms"]["others-instanced"] == 0.25 * load["frame_ms"][1]
    assert calibration["frame_ms"] == sorted(calibration["frame_ms"])
    flight = found["frames_in_flight"]["others-instanced"]
    assert list(flight) == ["alone", "1", "2", "3", "4"]
    assert all(value > 0.0 for value in flight["4"].values())
    assert list(flight["4"]) == ["interval_ms", "lag_ms", "cpu_ms"]
    assert found["recordings"]["others-instanced-flight-1"]["lag_ms_mean"] > 0.0
    with tarfile.open(out / "logs.tar.gz") as tar:
        tar.extractall(tmp_path, filter="data")
    log = read_render_log(tmp_path / "logs" / "balls-instanced-calibration.parquet")
    assert len(log) == 2 * 24
    assert list(scratch.iterdir()) == []


@pytest.mark.parametrize(
    ("frame_ms", "limit_s", "steps"),
    [
        # A quarter of 600 s is 150, less 15 to start; a pass of a frame takes 3 * 10 + 6 ms and 5.
        (10.0, 600.0, 480),
        (100.0, 600.0, int(0.8 * 135.0 / (2.0 * 0.311))),
        (10_000.0, 600.0, 60),  # too few to fit less
    ],
)
def test_a_programme_is_as_long_as_there_is_time(
    scratch: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    frame_ms: float,
    limit_s: float,
    steps: int,
) -> None:
    """By what a short one takes first."""
    asked: list[tuple[str, ...]] = []

    def run_child(command: tuple[str, ...], **_: Any) -> str:
        asked.append(command)
        if len(asked) > 1:
            raise ChildError("enough")
        return json.dumps({"frame_ms_mean": frame_ms, "reference_ms_mean": 1.0})

    monkeypatch.setattr(campaign, "run_child", run_child)
    what = Campaign(limit_s=limit_s, calibration=("plaza:tour",), scenes=(), draws=("each",))
    assert run_campaign(what, tmp_path / "out").errors == ["plaza-each-calibration: enough"]
    assert [command[command.index("--steps") + 1] for command in asked] == ["24", str(steps)]


def test_parts_that_fail_are_told_and_the_others_go_on(scratch: Path, tmp_path: Path) -> None:
    """A scene that is not there fails by name, each time, and a result is left all the same."""
    scenes = ("absent.lodscene:tour", "nothing.lodscene:tour")
    what = Campaign(calibration=scenes, scenes=(), draws=("each",))
    results = run_campaign(what, tmp_path / "out")
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
    with subprocess.Popen([*command, "--calibration", "city:tour"], env=environment) as run:
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
