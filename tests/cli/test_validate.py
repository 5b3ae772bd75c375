"""`lodbench validate`: from recording to report on a software rasteriser, and what it refuses."""

import json
from pathlib import Path
from typing import Any

import pytest

from lodbench.base.errors import InputError
from lodbench.cli.main import run
from lodbench.sim.frame_log_file import read_frame_log
from lodbench.traces.logs.read_log import read_render_log

pytestmark = pytest.mark.usefixtures("egl")

POLICIES = ["--policy", "full", "--policy", "feedback:gain=0.3"]
QUICK = [
    *("--scene", "market", "--trace", "drive", "--seconds", "0:0.15", "--size", "96x54"),
    *("--budget-ms", "4", "--warmup", "0.02", "--workers", "1", "--replicates", "19"),
    *("--clock", "thread"),  # other work on this machine does not make frames longer
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
    assert names == {"validation.json", "report.html", "recordings", "simulated"}
    stem = "feedback_gain=0.3"
    (case,) = (recorded / "recordings").iterdir()
    assert {path.stem for path in (case / "measured").iterdir()} == {
        *("full", stem, "again-full", f"again-{stem}")
    }
    log = read_render_log(case / "render" / f"{stem}.parquet")
    frames = read_frame_log(case / "measured" / f"{stem}.parquet")
    assert len(log) == len(frames)
    assert log.frame_ms is not None
    assert frames["gpu_ms"] == pytest.approx(log.frame_ms, rel=1e-6)
    assert not list(recorded.parent.glob(".*"))
    assert not list(recorded.parent.glob("*.recordings"))


@pytest.mark.slow
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
    assert document["schema"] == "lodbench.validate/3"
    assert document == before
    for file in (recorded / "recordings").rglob("*.parquet"):
        assert (out / file.relative_to(recorded)).read_bytes() == file.read_bytes()
    assert (out / "report.html").read_bytes() == (recorded / "report.html").read_bytes()


@pytest.mark.slow
def test_recordings_of_something_else_are_refused(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Recordings of another budget, size or path are named."""
    for option, value, message in (
        ("--budget-ms", "9", "expected a recording with budget_ms 9, got 4; record again"),
        ("--size", "48x48", "expected a recording with resolution 48x48, got 96x54"),
        ("--seconds", "0:0.9", "expected recordings of market-drive-0_0_0.9_s, got those"),
    ):
        other = [*QUICK, "--recorded", str(recorded), option, value]
        assert run(["validate", *other]) == 2
        assert message in capsys.readouterr().err


@pytest.mark.slow
def test_a_policy_without_a_recording_fails_and_the_others_do_not(
    recorded: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is named with the reason, and the exit code says that something failed."""
    other = [*QUICK, "--recorded", str(recorded), "--policy", "lodmanager", "--json"]
    assert run(["validate", *other]) == 1
    (case,) = json.loads(capsys.readouterr().out)["cases"]
    assert case["failed"] == {"lodmanager": "it was not recorded"}
    assert len(case["policies"]) == 2


@pytest.mark.slow
def test_what_was_recorded_before_a_failure_is_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: Any
) -> None:
    """The simulation fails; the recordings stand beside the folder, and are used from there."""
    out = tmp_path / "run"
    arguments = ["validate", *QUICK, "--passes", "1", "--repeats", "1", "--out", str(out)]
    with monkeypatch.context() as broken:
        broken.setattr("lodbench.analysis.validation.run_cases.simulate_all", _fail)
        assert run(arguments) == 2
    assert not out.exists()
    capsys.readouterr()
    assert run(arguments) == 2  # which would record over them
    assert f"use them with --recorded {out}.recordings" in capsys.readouterr().err
    assert run([*arguments, "--recorded", f"{out}.recordings"]) == 0  # as it was told
    assert (out / "recordings").is_dir()
    assert not Path(f"{out}.recordings").exists()


def _fail(*_: Any) -> None:
    raise InputError("a simulation that fails")


@pytest.mark.slow
def test_a_study_has_a_case_for_each_path(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two paths, one drawn two frames deep, are one document with what they say together."""
    study = tmp_path / "study.toml"
    study.write_text(
        '[[case]]\nscene = "market"\ntrace = "drive"\n\n'
        '[[case]]\nscene = "market"\ntrace = "walk"\npolicies = ["full"]\n'
        "frames_in_flight = 2\nthreads = 1\n",
        encoding="utf-8",
    )
    timed = ("--clock", "wall", "--seconds", "0:0.6", "--passes", "1", "--repeats", "1")
    code = run(["validate", str(study), *QUICK, *timed, "--json"])
    assert code == 0
    document = json.loads(capsys.readouterr().out)
    first, second = document["cases"]
    assert [policy["label"] for policy in first["policies"]] == ["full", "feedback:gain=0.3"]
    assert [policy["label"] for policy in second["policies"]] == ["full"]
    assert (first["frames_in_flight"], second["frames_in_flight"]) == (1, 2)
    lag = second["policies"][0]["metrics"]["lag_ms_mean"]
    assert lag["counted"]
    assert first["drift"] is not None
    counted = sum(case["inside"]["counted"] for case in (first, second))
    assert document["pooled"]["inside"]["counted"] == counted


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
        (["--replicates", "18"], "--replicates: expected 19 to"),
        (["none.toml"], "none.toml"),
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


@pytest.mark.parametrize(("told", "taken"), [([], 47.5), (["--fovy-deg", "80"], 80.0)])
def test_the_field_of_view_is_what_the_path_states(
    told: list[str],
    taken: float,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As of every command that replays a path, unless it is told."""
    path = tmp_path / "walk.csv"
    rows = "".join(f"{0.1 * i},{i},0,2,0.5,0.5,0.5,0.5\n" for i in range(8))
    header = '# lodbench.trace/1 {"name": "walk", "fovy_deg": 47.5}\n'
    path.write_text(f"{header}time_s,x_m,y_m,z_m,qx,qy,qz,qw\n{rows}", encoding="utf-8")

    def instead(cases: Any, *_: Any) -> None:
        raise InputError(f"a field of view of {cases[0].replay.fovy_deg}")

    monkeypatch.setattr("lodbench.analysis.validation.run_cases.carry_out", instead)
    assert run(["validate", *QUICK, "--trace", str(path), *told]) == 2
    note, error = capsys.readouterr().err.splitlines()
    assert note.startswith(f"note: field of view of {taken:g} degrees, ")
    assert error == f"error: a field of view of {taken}"


def test_a_folder_with_other_files_is_left_alone(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder that validate did not write is refused before anything is recorded."""
    (tmp_path / "precious.txt").write_text("mine", encoding="utf-8")
    assert run(["validate", *QUICK, "--out", str(tmp_path)]) == 2
    assert "precious.txt" in capsys.readouterr().err
