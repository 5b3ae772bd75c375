"""``lodbench trace``: information, conversion and generation on the command line."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from lodbench.base.errors import InputError
from lodbench.cli.trace import app
from lodbench.traces.cameras.generators.generate import KINDS, generate
from lodbench.traces.cameras.read_trace import read_trace


def run(*arguments: object) -> Result:
    """Run the command with these arguments."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def run_json(*arguments: object) -> dict[str, Any]:
    """Document that the command prints with ``--json``."""
    result = run(*arguments, "--json")
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.parametrize("kind", KINDS)
def test_generate_writes_what_the_library_makes(tmp_path: Path, kind: str) -> None:
    """Every kind can be written and equals the trace of the same seed."""
    out = tmp_path / "t.parquet"
    record = run_json("generate", kind, "--out", out, "--seed", 3, "--duration-s", 4)
    assert record["schema"] == "lodbench.trace-generate/1"
    assert (record["format"], record["duration_s"]) == ("parquet", 4.0)
    made = generate(kind, seed=3, duration_s=4.0)
    assert np.array_equal(read_trace(str(out)).position_m, made.position_m)


def test_generate_lists_every_kind_in_its_help() -> None:
    """The help, which must not load numpy, names the kinds that there are."""
    text = " ".join(run("generate", "--help").output.replace("│", " ").split())
    assert all(kind in text for kind in KINDS)


def test_info_is_one_document(tmp_path: Path) -> None:
    """The JSON holds the format, the statistics and the placement."""
    out = tmp_path / "t.csv"
    run_json("generate", "orbit", "--out", out, "--extent-m", 20)
    record = run_json("info", out, "--scale", 2)
    assert record["schema"] == "lodbench.trace-info/2"
    assert (record["format"], record["name"], record["samples"]) == ("csv", "orbit-0", 3601)
    assert record["speed_m_s"]["p50"] == pytest.approx(10.0, rel=1e-4)
    assert record["placement"]["scale"] == 2.0


def test_info_table_shows_the_same(tmp_path: Path) -> None:
    """Without ``--json`` a table shows duration, speeds and that the scale changed them."""
    out = tmp_path / "t.csv"
    run_json("generate", "teleport", "--out", out)
    output = run("info", out, "--scale", 2).output
    assert "60.000 s" in output
    assert "3601 at 60 Hz" in output
    assert "speeds are 2 times the source's" in output


def test_convert_there_and_back(tmp_path: Path) -> None:
    """CSV to Parquet to CSV gives the same bytes; TUM is read under its own name."""
    first, second, third = tmp_path / "a.csv", tmp_path / "b.parquet", tmp_path / "c.csv"
    run_json("generate", "walk", "--out", first, "--duration-s", 2)
    run_json("convert", first, second)
    record = run_json("convert", second, third)
    assert record["schema"] == "lodbench.trace-convert/1"
    assert first.read_bytes() == third.read_bytes()
    run_json("convert", first, tmp_path / "d.dat", "--to", "tum")
    assert run_json("info", tmp_path / "d.dat", "--from", "tum")["samples"] == 121


def test_convert_places_and_reports_repairs(tmp_path: Path) -> None:
    """Offset, yaw and scale are applied, and what was mended is said."""
    source = tmp_path / "a.txt"
    source.write_text("0 1 0 0 0 0 0 1\n0 9 9 9 0 0 0 1\n1 2 0 0 0 0 0 1\n")
    out = tmp_path / "b.csv"
    options = ["--scale", 2, "--yaw-deg", 90, "--offset-m", 10, 0, 1]
    result = run("convert", source, out, *options)
    assert "repaired: 1 repeated timestamps dropped" in result.output
    assert np.allclose(read_trace(str(out)).position_m, [[10, 2, 1], [10, 4, 1]])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["info", "absent.csv"], "absent.csv: expected a file that can be read"),
        (["info", "absent.csv", "--from", "tumm"], "trace format: expected one of"),
        (["generate", "fly", "--out", "a.csv"], "kind: expected one of walk"),
        (["generate", "walk", "--out", "a.dat"], "expected a name that ends in"),
        (["generate", "walk", "--out", "a.csv", "--duration-s", "-1"], "expected a duration"),
        (["convert", "absent.csv", "a.csv", "--scale", "0"], "expected a scale above 0"),
    ],
)
def test_bad_input_is_an_input_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, arguments: list[str], message: str
) -> None:
    """What the user gave wrongly comes out as the error that the command line prints."""
    monkeypatch.chdir(tmp_path)
    result = run(*arguments)
    assert isinstance(result.exception, InputError)
    assert message in str(result.exception)
    assert not list(tmp_path.iterdir())


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("spec", "format_name", "duration_s"),
    [
        ("tum-freiburg1-xyz.txt", "tum", 30.1),
        ("euroc-v102.csv", "euroc", 83.5),
        ("kitti-00.txt", "kitti", 470.6),
        ("kitti-00.txt#kitti-00-times.txt", "kitti", 470.6),
        ("hmd-6dof-h1.csv#P03_V1", "headset", 20.1),
    ],
)
def test_real_traces(
    data_dir: Path, tmp_path: Path, spec: str, format_name: str, duration_s: float
) -> None:
    """Every real trace is recognised, and converts to a native file with the same poses."""
    source = str(data_dir / "traces" / spec)
    record = run_json("info", source)
    assert record["format"] == format_name
    assert record["duration_s"] == pytest.approx(duration_s, abs=0.05)
    out = tmp_path / "t.csv"
    run_json("convert", source, out)
    assert np.array_equal(
        read_trace(str(out)).orientation_xyzw, read_trace(source).orientation_xyzw
    )
