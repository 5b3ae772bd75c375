"""`lodbench fit`: what it prints and writes, and what it refuses in one line."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lodbench.cli.main import run
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.machine.profile_file import read_profile

QUICK = ["--steps", "500", "--heldout", "none"]


def write_log(
    path: Path, *, frames: int = 120, header: str = "draw_calls,triangles,gpu_ms"
) -> Path:
    """Write a log of 4 ms + 20 us a draw + 5 ns a triangle and 0.5 ms of noise."""
    rng = np.random.default_rng(4)
    draws, triangles = rng.integers(50, 400, frames), rng.integers(200_000, 2_000_000, frames)
    time_ms = 4.0 + 0.02 * draws + 5e-6 * triangles + 0.5 * rng.standard_normal(frames)
    rows = [f"{d},{t},{ms:.4f}" for d, t, ms in zip(draws, triangles, time_ms, strict=True)]
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    return path


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a log in the current folder, which is empty otherwise."""
    monkeypatch.chdir(tmp_path)
    return write_log(Path("walk.csv"))


def test_json_is_the_promised_document(log: Path, capsys: pytest.CaptureFixture[str]):
    """Terms are chosen, every coefficient has its interval, and held-out frames their error."""
    assert run(["fit", str(log), "--json", "--steps", "1000"]) == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert record["schema"] == "lodbench.fit/1"
    assert record["target"] == "gpu_ms"
    assert (record["rows"], record["rows_rejected"]) == (117, 3)
    assert record["terms"] == ["draw_calls", "triangles"]
    triangles = record["coefficients"]["triangles"]
    assert triangles["unit"] == "ns"
    assert triangles["q05"] < 5.0 < triangles["q95"]
    assert len(record["logs"][0]["sha256"]) == 64
    heldout = record["heldout"]
    assert set(heldout) >= {"rows", "error_pct_mean", "error_pct_sd", "coverage_90"}
    assert abs(heldout["error_pct_mean"]) < 3.0


def test_the_table_says_priors_terms_and_errors(log: Path, capsys: pytest.CaptureFixture[str]):
    """The thesis's error stands beside the log's."""
    assert run(["fit", str(log), "--model", "gaussian", "--predict", str(log)]) == 0
    printed = " ".join(capsys.readouterr().out.split())
    for part in ("half-normal", "draw_calls, triangles", "4.39 % ± 15.19 %", "R-hat", "walk"):
        assert part in printed


def test_the_profile_is_written_and_is_the_same_each_time(log: Path):
    """Same log, same seed, same bytes; the date only where it is given."""
    for name in ("one.toml", "two.toml"):
        assert run(["fit", str(log), *QUICK, "--date", "2025-01-02", "--out", name]) == 0
    one, two = Path("one.toml").read_text("utf-8"), Path("two.toml").read_text("utf-8")
    assert one.replace('"one"', '"two"') == two
    profile = read_profile(Path("one.toml"))
    assert profile.provenance.date == "2025-01-02"
    assert profile.posterior is not None


def test_a_fitted_profile_is_a_machine_for_compare(log: Path, capsys: pytest.CaptureFixture[str]):
    """The draws of the posterior are replayed, and the machine's doubt is in the intervals."""
    assert run(["fit", str(log), *QUICK, "--out", "mine.toml"]) == 0
    capsys.readouterr()
    arguments = ["--hardware", "mine.toml", "--policy", "full", "--scene", "plaza", "--json"]
    arguments += ["--trace", "walk", "--paths", "2", "--seconds", "0:2", "--seeds", "2"]
    assert run(["compare", *arguments, "--draws", "4", "--workers", "1"]) == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    score = record["policies"][0]["metrics"]["work_ms_mean"]
    assert record["hardware"] == "mine"
    assert record["sampling"]["draws"] == 4
    (low, high), (narrow_low, narrow_high) = score["with_machine"], score["such_paths"]
    assert low < narrow_low < score["value"] < narrow_high < high


def test_columns_are_mapped(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A log with names of its own is fitted once they are told."""
    path = write_log(tmp_path / "own.csv", header="Calls9,Prims9,Span9")
    mapping = "draw_calls=Calls9,triangles=Prims9,gpu_ms=Span9"
    assert run(["fit", str(path), "--map", mapping, *QUICK, "--json"]) == 0
    (note,) = json.loads(capsys.readouterr().out)["logs"][0]["notes"]
    assert note.startswith("gpu_ms is Span9 in milliseconds, by their size: the median is 1")


def test_a_short_chain_is_a_warning_and_with_strict_a_failure(
    log: Path, capsys: pytest.CaptureFixture[str]
):
    """Exit 1, and no profile is left."""
    short = ["fit", str(log), "--steps", "60", "--heldout", "none", "--out", "mine.toml"]
    assert run([*short, "--strict"]) == 1
    assert "fewer than 50" in capsys.readouterr().err
    assert not Path("mine.toml").exists()
    assert run(short) == 0
    assert "warning: the chain has" in capsys.readouterr().err
    assert Path("mine.toml").exists()


def test_a_fit_that_does_not_predict_writes_no_profile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """Times that hardly follow the counts: exit 1 with one line, unless it is wanted anyway."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(7)
    draws = rng.integers(50, 400, 200)
    time_ms = (4.0 + 0.02 * draws) * rng.lognormal(0.0, 1.0, 200)
    rows = [f"{d},{ms:.4f}" for d, ms in zip(draws, time_ms, strict=True)]
    Path("wild.csv").write_text("\n".join(["draw_calls,gpu_ms", *rows]) + "\n", "utf-8")
    asked = ["fit", "wild.csv", "--steps", "500", "--terms", "draw_calls", "--out", "mine.toml"]
    assert run(asked) == 1
    (line,) = [one for one in capsys.readouterr().err.splitlines() if one.startswith("error")]
    assert line.startswith("error: mine.toml: not written, since of frames held out by blocks")
    assert not Path("mine.toml").exists()
    assert run([*asked, "--anyway"]) == 0
    assert Path("mine.toml").exists()


def test_gpu_and_cpu_are_fitted_from_one_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """4 ms + 5 ns a triangle of the GPU and 1 ms + 8 us a draw of the CPU, into one profile."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(8)
    draws, triangles = rng.integers(50, 400, 300), rng.integers(200_000, 2_000_000, 300)
    gpu_ms = 4.0 + 5e-6 * triangles + 0.2 * rng.standard_normal(300)
    cpu_ms = 1.0 + 0.008 * draws + 0.05 * rng.standard_normal(300)
    rows = zip(draws, triangles, gpu_ms, cpu_ms, strict=True)
    lines = [f"{d},{t},{g:.4f},{c:.4f}" for d, t, g, c in rows]
    head = ["# resolution: 800x600", "draw_calls,triangles,gpu_ms,cpu_ms"]
    Path("both.csv").write_text("\n".join([*head, *lines]) + "\n", "utf-8")
    assert run(["fit", "both.csv", *QUICK, "--json", "--out", "mine.toml"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["terms"] == ["triangles"]
    assert record["cpu"]["target"] == "cpu_ms"
    assert record["cpu"]["coefficients"]["draw_calls"]["mean"] == pytest.approx(8.0, rel=0.05)
    profile = read_profile(Path("mine.toml"))
    assert profile.cpu.base_ms == pytest.approx(1.0, rel=0.1)
    assert profile.gpu.base_ms == pytest.approx(4.0, rel=0.1)
    assert (profile.display.width_px, profile.display.height_px) == (800, 600)


def test_a_lag_that_is_told_is_of_one_timer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """Where the GPU's timer is two frames late, the CPU's times stay where they are."""
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(8)
    draws = rng.integers(50, 400, 300)
    late_ms = np.roll(4.0 + 0.02 * draws, 2) + 0.05 * rng.standard_normal(300)
    cpu_ms = 1.0 + 0.008 * draws + 0.05 * rng.standard_normal(300)
    rows = [f"{d},{g:.4f},{c:.4f}" for d, g, c in zip(draws, late_ms, cpu_ms, strict=True)]
    Path("late.csv").write_text("\n".join(["draw_calls,gpu_ms,cpu_ms", *rows]) + "\n", "utf-8")
    assert run(["fit", "late.csv", *QUICK, "--lag", "2", "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert (record["lag_frames"], record["cpu"]["lag_frames"]) == ([2], [0])
    assert record["cpu"]["coefficients"]["draw_calls"]["mean"] == pytest.approx(8.0, rel=0.05)


@pytest.mark.parametrize("frames", [3, 4, 8])
def test_a_log_too_short_among_others_is_named(
    log: Path, frames: int, capsys: pytest.CaptureFixture[str]
):
    """Three frames are left out as the first; of the rest there is none, or too few."""
    write_log(Path("short.csv"), frames=frames)
    assert run(["fit", str(log), "short.csv", *QUICK, "--terms", "draw_calls,triangles"]) == 2
    says = f"error: short: expected at least 10 frames that count, got {frames - 3}"
    assert capsys.readouterr().err.startswith(says)


def test_several_logs_are_occasions_and_scenes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """Four logs of two scenes on two days: what one log assumes is told from them where it can."""
    monkeypatch.chdir(tmp_path)
    names: list[str] = []
    for scene in ("plaza", "market"):
        for day in ("monday", "friday"):
            path = write_log(Path(f"{scene}-{day}.csv"), frames=150)
            text = path.read_text("utf-8")
            path.write_text(f"# scene: {scene}; occasion: {day}\n{text}", "utf-8")
            names.append(str(path))
    terms = ["--terms", "draw_calls,triangles"]
    assert run(["fit", *names, *terms, *QUICK, "--json", "--out", "mine.toml"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["occasions"]["count"] == 2
    assert not record["occasions"]["assumed"]
    assert record["occasions"]["log_sd"] < 0.09  # the same frames in both
    assert record["between_scenes"]["count"] == 2
    assert record["between_scenes"]["assumed"]
    assert record["lag_frames"] == [0, 0, 0, 0]
    assert run(["fit", names[0], *terms, *QUICK, "--json", "--out", "one.toml"]) == 0
    one = json.loads(capsys.readouterr().out)
    assert one["occasions"] == {"count": 1, "log_sd": 0.09, "assumed": True}
    scatter = read_profile(Path("one.toml")).scatter
    assert scatter.assumed
    assert dict(scatter.scenes) == {"base": 0.25, "triangles": 0.25}
    assert read_profile(Path("mine.toml")).scatter.occasion == record["occasions"]["log_sd"]


def test_a_late_timer_is_found_among_lags_of_0_to_6(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """Times written three rows late: lag 3, with what each lag explains."""
    monkeypatch.chdir(tmp_path)
    lines = write_log(Path("walk.csv"), frames=300).read_text("utf-8").splitlines()
    cells = [line.split(",") for line in lines[1:]]
    late = [",".join((*now[:2], before[2])) for now, before in zip(cells[3:], cells, strict=False)]
    Path("late.csv").write_text("\n".join([lines[0], *late]) + "\n", "utf-8")
    assert run(["fit", "late.csv", *QUICK, "--json", "--terms", "draw_calls,triangles"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["lag_frames"] == [3]
    (shares,) = record["lag_explains"]
    assert len(shares) == 7
    assert max(shares) == shares[3]


def test_a_chain_is_kept_and_gone_on_with(log: Path, capsys: pytest.CaptureFixture[str]):
    """The second run reads the whole chain from the file and prints the same."""
    arguments = ["fit", str(log), *QUICK, "--resume", "chain.npz", "--json"]
    assert run(arguments) == 0
    first = capsys.readouterr().out
    before = Path("chain.npz").read_bytes()
    assert run(arguments) == 0
    assert capsys.readouterr().out == first
    assert Path("chain.npz").read_bytes() == before
    assert run([*arguments, "--seed", "1"]) == 2
    assert "chain.npz: expected a chain of this log" in capsys.readouterr().err


BUNDLED = ["fit", "--bundled", "llvmpipe", *QUICK]


def test_a_bundled_profile_is_fitted_again_with_its_own_settings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Terms, target, log and file are those of the profile, without an option more."""
    out = tmp_path / "llvmpipe.toml"
    assert run([*BUNDLED, "--json", "--out", str(out)]) == 0
    record = json.loads(capsys.readouterr().out)
    again, bundled = read_profile(out), load_hardware("llvmpipe")
    assert record["target"] == "frame_ms"
    assert again.name == bundled.name
    assert again.provenance == bundled.provenance
    assert (again.gpu.linear_ms > 0.0).tolist() == (bundled.gpu.linear_ms > 0.0).tolist()


def test_settings_of_a_bundled_profile_give_way_to_given_ones(capsys: pytest.CaptureFixture[str]):
    """Terms, target and columns that are asked for are fitted in their place."""
    chosen = ["--terms", "vertices", "--target", "cpu_ms", "--map", "vertices=triangles"]
    assert run([*BUNDLED, *chosen, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert (record["target"], record["terms"]) == ("cpu_ms", ["vertices"])
    assert run([*BUNDLED, "--terms", "triangles", "--target", "cpu_ms", "--json"]) == 0
    unmapped = json.loads(capsys.readouterr().out)["coefficients"]["triangles"]["mean"]
    assert record["coefficients"]["vertices"]["mean"] == unmapped


def test_plots_are_written(log: Path):
    """Two pictures, if the extra is there."""
    pytest.importorskip("corner")
    assert run(["fit", str(log), *QUICK, "--model", "gaussian", "--plots", "pictures"]) == 0
    assert sorted(path.name for path in Path("pictures").iterdir()) == ["corner.png", "trace.png"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["missing.csv"], "missing.csv: expected a file that can be read"),
        (["walk.csv", "--target", "fps"], "--target: expected one of gpu_ms, frame_ms, cpu_ms"),
        (["walk.csv", "--target", "cpu_ms"], "expected the time cpu_ms, got a log with gpu_ms"),
        (["walk.csv", "--terms", "draws"], "--terms: expected predictors among draw_calls"),
        (["walk.csv", "--terms", "vertices"], "expected the predictors vertices, got a log with"),
        (["walk.csv", "--model", "normal"], "--model: expected one of student-t, gaussian"),
        (["walk.csv", "--heldout", "some"], "--heldout: expected one of blocks, halves"),
        (["walk.csv", "--heldout", "logs"], "--heldout logs: expected two logs or more, got one"),
        (["walk.csv", "--map", "gpu_ms"], "--map: expected name=COLUMN"),
        (["walk.csv", "--map", "gpu_ms=Nope"], "mapping of gpu_ms: expected one of"),
        (["walk.csv", "--format", "excel"], "log format: expected one of parquet"),
        (["walk.csv", "--out", "mine.json"], "mine.json: expected a .toml file"),
        (["walk.csv", "--out", "no/mine.toml"], "no/mine.toml: expected a .toml file in a folder"),
        (
            ["walk.csv", "--terms", "draw_calls*triangles", "--out", "mine.toml"],
            "--out: expected terms that a profile of gpu_ms can hold",
        ),
        (["walk.csv", "--onto", "nowhere"], "hardware: expected one of"),
        (["walk.csv", "--predict", "missing.csv"], "missing.csv: expected a file"),
        ([], "fit: expected LOG… or --bundled PROFILE, got neither"),
        (["walk.csv", "--bundled", "llvmpipe"], "LOG… or --bundled PROFILE, got both"),
        (["--bundled", "llvmpip"], "one of llvmpipe, got llvmpip; did you mean llvmpipe?"),
    ],
)
def test_mistakes_are_one_line(
    log: Path, arguments: list[str], says: str, capsys: pytest.CaptureFixture[str]
):
    """Exit 2, `error:`, no traceback, nothing written."""
    assert log.exists()
    assert run(["fit", *arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert printed.err.count("\n") == 1
    assert says in printed.err
    assert [path.name for path in Path().iterdir()] == ["walk.csv"]


GOOD = "draw_calls,triangles,gpu_ms\n" + "".join(
    f"{100 + i % 7},{1000 * (i % 11)},{10 + i % 5}.5\n" for i in range(40)
)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("", "bad.csv: expected text, got an empty file"),
        (b"\x00\x01\xff\xfe binary \x80", "bad.csv:1: expected UTF-8 text, got byte 0xff"),
        (GOOD.split("\n", 1)[0], "expected rows below the header, got none"),
        (GOOD.split("\n", 1)[1], "expected a header row with names, got numbers"),
        (GOOD.replace(".5", ",5"), "decimal commas, or thousands?"),
        (GOOD.split("\n", 1)[0] + "\n" + GOOD.split("\n", 1)[1].replace(",", ";"), "delimiter"),
        (GOOD.replace("draw_calls", "triangles"), "expected one column triangles, got 2"),
        (GOOD.replace("gpu_ms", "mood"), "expected a column with a time"),
        ("\n".join(GOOD.split("\n")[:7]) + "\n", "expected at least 16 frames to choose among"),
        ("triangles,gpu_ms\n" + "1,-3\n" * 9, "missing, zero or negative in 100% of frames"),
        ("draw_calls,gpu_ms\n" + "5,3.5\n" * 50, "the view stands still"),
    ],
)
def test_bad_logs_are_one_line(
    tmp_path: Path, content: str | bytes, says: str, capsys: pytest.CaptureFixture[str]
):
    """Empty, binary, truncated, wrong delimiter, decimal commas, no header, twice a column, few."""
    path = tmp_path / "bad.csv"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    assert run(["fit", str(path), "--terms", "auto"]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert printed.err.count("\n") == 1
    assert says in printed.err


def test_mixed_line_ends_are_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Windows and old Mac line ends in one file change nothing."""
    path = write_log(tmp_path / "walk.csv")
    arguments = ["fit", str(path), *QUICK, "--model", "gaussian", "--json"]
    assert run(arguments) == 0
    plain = json.loads(capsys.readouterr().out)["coefficients"]
    lines = path.read_bytes().split(b"\n")
    ends = (b"\r\n", b"\n", b"\r")
    path.write_bytes(b"".join(line + ends[i % 3] for i, line in enumerate(lines[:-1])))
    assert run(arguments) == 0
    assert json.loads(capsys.readouterr().out)["coefficients"] == plain


def test_help_does_not_wait_for_the_sampler():
    """Neither emcee nor scipy is loaded to show the options."""
    code = (
        "import sys; from lodbench.cli.main import run; run(['fit', '--help']); "
        "sys.exit(len({'emcee', 'scipy', 'numpy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "--terms" in done.stdout
