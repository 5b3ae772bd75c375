"""`lodbench validate`: from recording to report on a software rasteriser, and what it refuses."""

import json
from pathlib import Path
from typing import Any

import pytest

from lodbench.cli.main import run
from lodbench.sim.frame_log_file import read_frame_log
from lodbench.traces.logs.read_log import read_render_log

pytestmark = pytest.mark.usefixtures("egl")

POLICIES = ["--policy", "full", "--policy", "feedback:gain=0.3"]
QUICK = [
    *("--scene", "plaza", "--trace", "drive", "--seconds", "0:0.15", "--size", "96x54"),
    *("--budget-ms", "4", "--warmup", "0.02", "--draws", "1", "--workers", "1"),
    *POLICIES,
]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Record two policies twice and validate."""
    folder = tmp_path_factory.mktemp("validate") / "run"
    assert run(["validate", *QUICK, "--repeats", "1", "--out", str(folder)]) == 0
    return folder


@pytest.mark.slow
def test_everything_is_written(recorded: Path) -> None:
    """Recordings, simulated replays, record and page are there, and nothing else."""
    names = {path.name for path in recorded.iterdir()}
    assert names == {"validation.json", "report.html", "measured", "render", "simulated"}
    stem = "feedback_gain=0.3"
    assert {path.stem for path in (recorded / "measured").iterdir()} == {
        *("full", stem, "again-full", f"again-{stem}")
    }
    log = read_render_log(recorded / "render" / f"{stem}.parquet")
    frames = read_frame_log(recorded / "measured" / f"{stem}.parquet")
    assert len(log) == len(frames)
    assert log.frame_ms is not None
    assert frames["gpu_ms"] == pytest.approx(log.frame_ms, rel=1e-6)
    assert not list(recorded.parent.glob(".*"))


def test_recordings_are_compared_again_without_a_device(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: Any
) -> None:
    """From its recordings the same validation comes out, with no OpenGL at all."""
    monkeypatch.setattr("lodbench.render.gl.context.open_target", None)
    out = tmp_path / "again"
    arguments = ["validate", *QUICK, "--recorded", str(recorded), "--out", str(out), "--json"]
    assert run(arguments) == 0
    document = json.loads(capsys.readouterr().out)
    before = json.loads((recorded / "validation.json").read_text(encoding="utf-8"))
    assert document["schema"] == "lodbench.validate/2"
    for key in ("ranks", "inside"):
        assert document[key] == before[key]
    for mine, theirs in zip(document["policies"], before["policies"], strict=True):
        assert mine["metrics"] == theirs["metrics"]
        assert mine["errors"]["model"] == pytest.approx(theirs["errors"]["model"], rel=1e-3)
    assert (out / "render" / "full.parquet").read_bytes() == (
        recorded / "render" / "full.parquet"
    ).read_bytes()


def test_recordings_of_something_else_are_refused(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Recordings of another budget, or of a policy that was not recorded, are named."""
    for option, value, message in (
        ("--budget-ms", "9", "expected a recording with budget_ms 9, got 4; record again"),
        ("--size", "48x48", "expected a recording with resolution 48x48, got 96x54"),
        ("--seconds", "0:0.9", "expected a recording with trace drive-0 0:0.9 s, got"),
        ("--policy", "lodmanager", "expected a recording of lodmanager, got none"),
    ):
        other = [*QUICK, "--recorded", str(recorded), option, value]
        assert run(["validate", *other]) == 2
        assert message in capsys.readouterr().err


def test_the_frames_of_the_calibration_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """The bundled profile is of plaza along tour, and is not validated there."""
    assert run(["validate", "--scene", "plaza", "--trace", "tour"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("error: --hardware llvmpipe: expected a profile calibrated on other")


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (["--policy", "full"], "expected each once"),
        (["--passes", "3"], "--passes: expected 1 or 2, got 3"),
        (["--seconds", "0:0"], "seconds: expected a stretch of drive"),
        (["--seconds", "nan:"], "seconds: expected a stretch of drive"),
        (["--warmup", "-3"], "warmup: expected seconds >= 0"),
        (["--hardware", "geforce2go-2002"], "--hardware geforce2go-2002: expected"),
        (["--policy", "oracle"], "it sees the future"),
        (["--policy", "mason-blake"], "expected a policy that can be recorded"),
        (["--repeats", "0"], "--repeats: expected 1 to 99"),
    ],
)
def test_what_cannot_be_validated_is_refused(
    wrong: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line, exit code 2, and no folder."""
    out = tmp_path / "never"
    assert run(["validate", *QUICK, *wrong, "--out", str(out)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not out.exists()


def test_a_folder_with_other_files_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder that validate did not write is refused before anything is recorded."""
    (tmp_path / "precious.txt").write_text("mine", encoding="utf-8")
    assert run(["validate", *QUICK, "--out", str(tmp_path)]) == 2
    assert "precious.txt" in capsys.readouterr().err
