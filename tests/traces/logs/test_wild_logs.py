"""Logs as users have them: each real kind of file, and the value that it must give."""

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.cli.main import run
from lodbench.traces.logs.checks.late import frames_late, shifted
from lodbench.traces.logs.log_checks import check_log
from lodbench.traces.logs.read_log import read_render_log
from lodbench.traces.logs.render_log import RenderLog, TimeName, measurable

# File, target, mapping, and the truth: base in ms, a draw call in us, a triangle in ns.
ENGINES: list[tuple[str, TimeName, dict[str, str] | None, tuple[float, float, float]]] = [
    ("time-column-mapped-crash.csv", "gpu_ms", {"gpu_ms": "time"}, (1.0, 4.0, 5.0)),
    ("fastgpu-refused-as-capped.csv", "gpu_ms", None, (0.012, 0.8, 0.3)),
    ("deltaTime-seconds-accepted-as-ms.csv", "frame_ms", None, (1.0, 1.0, 2.0)),
    ("gpu-timer-2-frames-late.csv", "gpu_ms", None, (1.0, 1.0, 2.0)),
    ("godot-render_gpu_ms-ignored.csv", "gpu_ms", None, (1.0, 1.0, 2.0)),
    ("repeated-header.csv", "gpu_ms", None, (1.0, 1.0, 2.0)),
    ("json-records.json", "gpu_ms", None, (1.0, 1.0, 2.0)),
]


def coefficients(log: RenderLog, target: TimeName) -> np.ndarray:
    """Fit base, draw call and triangle by robust least squares: ms, us and ns."""
    log = shifted(log, target, frames_late(log, target)[0])
    names = ["draw_calls", "triangles"]
    keep, _ = measurable(log, target, names)
    design = np.column_stack((np.ones(keep.sum()), log.columns(names)[keep] / (1e3, 1e6)))
    time_ms = log.time(target)[keep]
    weight = np.ones(len(time_ms))
    found = np.zeros(design.shape[1])
    for _ in range(20):
        root = np.sqrt(weight)
        found = np.linalg.lstsq(design * root[:, np.newaxis], time_ms * root, rcond=None)[0]
        away = np.abs(time_ms - design @ found)
        weight = 1.0 / np.maximum(away / max(np.median(away), 1e-9), 1.0)
    return found


@pytest.mark.realdata
@pytest.mark.parametrize(("name", "target", "mapping", "truth"), ENGINES)
def test_logs_of_engines_give_the_truth(
    data_dir: Path,
    name: str,
    target: TimeName,
    mapping: dict[str, str] | None,
    truth: tuple[float, float, float],
):
    """The fit of the file is that of the model by which its rows were made, within 10 %."""
    log = read_render_log(data_dir / "wild" / "logs" / name, mapping)
    assert not [finding for finding in check_log(log) if finding.refuse]
    assert coefficients(log, target) == pytest.approx(truth, rel=0.1)


@pytest.mark.realdata
def test_what_was_found_is_said(data_dir: Path):
    """Seconds, a late timer, and a time that nobody used are told, each where it is."""
    folder = data_dir / "wild" / "logs"
    seconds = read_render_log(folder / "deltaTime-seconds-accepted-as-ms.csv")
    assert any("deltaTime in seconds" in note for note in seconds.notes)
    late = check_log(read_render_log(folder / "gpu-timer-2-frames-late.csv"))
    assert any("gpu_ms is late by 2 frames" in finding.message for finding in late)
    godot = read_render_log(folder / "godot-render_gpu_ms-ignored.csv")
    assert any("process_ms" in warning for warning in godot.warnings)
    assert "gpu_ms is render_gpu_ms in ms" in godot.notes


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "log_format", "frame_ms"),
    [
        ("frameview-dropped-error.csv", "presentmon-v1", [4.589, 4.718, 4.633, 4.578, 4.622]),
        ("ocat-no-comment-ragged.csv", "presentmon-v1", [9.681, 12.166, 10.579, 17.945, 10.22]),
        ("gfxinfo.txt", "android-framestats", [3.759, 13.752]),
        ("afterburner.csv", "afterburner", [10.031, 10.273]),
    ],
)
def test_tools_are_read_for_their_times(
    data_dir: Path, name: str, log_format: str, frame_ms: list[float]
):
    """Rows that lack columns or hold Error do not cost the frame times."""
    log = read_render_log(data_dir / "wild" / "logs" / name)
    assert log.format == log_format
    got = log.time("frame_ms")[: len(frame_ms)]
    assert got == pytest.approx(frame_ms, abs=6e-4)
    assert len(log) == {"frameview-dropped-error.csv": 9, "afterburner.csv": 14}.get(
        name, len(frame_ms)
    )


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "says"),
    [("afterburner.csv", "MSI Afterburner samples"), ("gfxinfo.txt", "Android framestats hold")],
)
def test_what_cannot_be_fitted_says_what_to_record(
    data_dir: Path, name: str, says: str, capsys: pytest.CaptureFixture[str]
):
    """The error names the tool, and what to record instead."""
    assert run(["fit", str(data_dir / "wild" / "logs" / name), "--target", "frame_ms"]) == 2
    printed = capsys.readouterr().err
    assert says in printed
    assert "draw calls and triangles" in printed


@pytest.mark.realdata
def test_damaged_logs_are_read_or_refused_in_one_line(data_dir: Path):
    """No exception but InputError, none slow, none long, and none that moves the cursor."""
    for path in sorted((data_dir / "wild" / "damaged").glob("log-*")):
        start = time.perf_counter()
        try:
            check_log(read_render_log(path))
        except InputError as error:
            message = str(error)
            assert message.isprintable(), path.name
            assert len(message) <= 300 + len(str(path)), path.name
        assert time.perf_counter() - start < 2.0, path.name


@pytest.mark.realdata
@pytest.mark.parametrize(
    ("name", "average", "percentile", "mean", "integral"),
    [
        ("presentmon-v1-farcrynewdawn.csv", 76.8, 59.4, 29.5, 12.5),
        ("ocat-metroexodus.csv", 98.6, 79.0, 73.7, 78.1),
        ("capframex-with-header.csv", 286.3, 259.1, 248.7, 258.5),
        ("threejs-pirateconquest-large_battle.csv", 60.0, 41.8, 39.5, 40.5),
    ],
)
def test_log_info_agrees_with_the_tools(
    data_dir: Path,
    name: str,
    average: float,
    percentile: float,
    mean: float,
    integral: float,
    capsys: pytest.CaptureFixture[str],
):
    """Average and the three 1 % lows are what CapFrameX and PresentMon define, to their digits."""
    assert run(["log", "info", str(data_dir / "logs" / name), "--json"]) == 0
    record: dict[str, Any] = json.loads(capsys.readouterr().out)
    ids = ("average_fps", "fps_low1_percentile", "fps_low1_mean", "fps_low1_integral")
    values = [record["metrics"][metric]["frames"] for metric in ids]
    assert values == pytest.approx([average, percentile, mean, integral], abs=0.06)


# -- any header, any unit, any mapping ------------------------------------------------------------

UNITS = {"ns": 1e6, "us": 1e3, "ms": 1.0, "s": 1e-3}
STEMS = {
    "frame_ms": ("frame time", "frame", "delta time", "interval", "FrameTime", "dt"),
    "gpu_ms": ("gpu time", "gpu", "render gpu", "FrameGPUTime", "gpuBusy", "GPU Frame Time"),
    "cpu_ms": ("cpu time", "cpu", "game thread", "main thread", "cpuBusy", "render cpu"),
}
OTHERS = ("frame no", "process", "fps", "tris", "draws", "gpu temp", "Budget", "name", "wait")


def spelt(words: str, unit: str, style: int) -> str:
    """Write a name as engines do: snake, camel, spaced with brackets, capitals, or no unit."""
    parts = words.split()
    camel = parts[0] + "".join(part[:1].upper() + part[1:] for part in parts[1:])
    forms = (
        "_".join([*parts, unit]),
        camel + unit.capitalize(),
        f"{words} ({unit})",
        "_".join([*parts, unit]).upper(),
        words
        if len(parts) > 1 or words in ("dt", "FrameTime", "FrameGPUTime")
        else f"{words} time",
    )
    return forms[style % len(forms)]


@st.composite
def headers(draw: st.DrawFn) -> tuple[list[tuple[str, str, str]], list[str], dict[str, str]]:
    """Return columns (role, name, unit), other columns, and a mapping."""
    roles = draw(st.lists(st.sampled_from(sorted(STEMS)), min_size=1, max_size=3, unique=True))
    columns: list[tuple[str, str, str]] = []
    for role in roles:
        unit = draw(st.sampled_from(sorted(UNITS)))
        stem = draw(st.sampled_from(STEMS[role]))
        columns.append((role, spelt(stem, unit, draw(st.integers(0, 4))), unit))
    others: list[str] = draw(st.lists(st.sampled_from(OTHERS), max_size=4, unique=True))
    mapping: dict[str, str] = {}
    if draw(st.booleans()):
        role, name, unit = draw(st.sampled_from(columns))
        mapping[role] = f"{name}:{unit}" if draw(st.booleans()) else name
    return columns, others, mapping


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(headers(), st.floats(0.3, 150.0), st.integers(0, 5))
def test_no_time_is_lost_in_silence(
    tmp_path_factory: pytest.TempPathFactory,
    drawn: tuple[list[tuple[str, str, str]], list[str], dict[str, str]],
    size_ms: float,
    seed: int,
):
    """Each time is read as it was written, or refused, or named as not used."""
    columns, others, mapping = drawn
    rng = np.random.default_rng(seed)
    names = [*(name for _, name, _ in columns), *others]
    times_ms = size_ms * rng.uniform(0.7, 1.3, (40, len(columns)))
    rows = [
        [*(value * UNITS[unit] for value, (_, _, unit) in zip(row, columns, strict=True)), *tail]
        for row, tail in zip(times_ms, rng.integers(1, 900, (40, len(others))), strict=True)
    ]
    path = tmp_path_factory.getbasetemp() / "any.csv"
    # Sixteen digits: of nanoseconds and seconds alike, no unit is to be lost by rounding.
    lines = [",".join(names), *(",".join(f"{float(cell):.16g}" for cell in row) for row in rows)]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    log, refusal = None, ""
    try:
        log = read_render_log(path, mapping or None)
    except InputError as error:
        refusal = error.message
    assert refusal.isprintable()
    assert len(refusal) <= 300
    if log is None:
        assert refusal
        return
    told = " ".join((*log.notes, *log.warnings, *log.unused))
    for place, (role, name, _) in enumerate(columns):
        if name in (source.source for source in log.sources if source.name == role):
            both = [c for c in columns if c[0] == role]
            if len(both) == 1:
                np.testing.assert_allclose(log.time(role), times_ms[:, place], rtol=1e-9)  # pyright: ignore[reportArgumentType]
        else:
            assert name in told, (name, log.notes, log.warnings)
