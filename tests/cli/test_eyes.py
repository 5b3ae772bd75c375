"""Two eyes and several players by options, by names and by keys of a study."""

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import lodbench
from lodbench.analysis.gate.check import CheckPlan, measure_plan
from lodbench.analysis.gate.measurements import MeasureOptions
from lodbench.analysis.study.sweep.study_file import read_study
from lodbench.base.errors import InputError
from lodbench.cli.main import run
from lodbench.cli.shared.eyes import make_eyes
from lodbench.models.scene.rig import Eyes
from lodbench.render.gl.opengl_machine import GlMachine
from lodbench.traces.cameras.shared_screen import split

QUICK = [
    *("compare", "--scene", "plaza", "--as-shipped", "--seeds", "1", "--draws", "0"),
    *("--workers", "1", "--policy", "static-screen", "--json", "--warmup", "0.2"),
    *("--seconds", "0:0.5"),
]


def test_options_say_what_eyes_there_are() -> None:
    """The distance alone, or with a picture's size, and whether objects are submitted once."""
    assert make_eyes(None, None, single_pass=False) is None
    assert make_eyes(0.064, None, single_pass=False) == Eyes(apart_m=0.064)
    given = make_eyes(0.06, "800x900", single_pass=True)
    assert given == Eyes(apart_m=0.06, size_px=(800, 900), single_pass=True)
    assert str(given) == "60 mm apart, 800 × 900 px each, in a single pass"


@pytest.mark.parametrize("options", [["--single-pass"], ["--eye-size", "800x900"]])
def test_eyes_that_are_described_and_not_asked_for_are_refused(
    options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """Or a headset would be compared as one camera, and nobody told."""
    assert run([*QUICK, "--trace", "tour", *options]) == 2
    assert f"{options[0]}: expected two eyes, got one camera; add --eyes" in capsys.readouterr().err


def test_paths_that_do_not_do_for_all_players_are_refused(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """One path is not shared by two; nobody would be the second."""
    assert run([*QUICK, "--trace", "tour", "--players", "2"]) == 2
    assert "got 2 and 1 paths; name a path for each player" in capsys.readouterr().err


@pytest.mark.slow
def test_a_comparison_says_under_what_eyes_it_was_made(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Two that differ in this alone are not taken for one another."""
    assert run([*QUICK, "--trace", "tour", "--eyes", "0.064", "--single-pass"]) == 0
    document = json.loads(capsys.readouterr().out)
    told = {"apart_m": 0.064, "size_px": None, "single_pass": True}
    assert document["conditions"]["eyes"] == told


def test_a_distance_stands_for_eyes() -> None:
    """A replay takes either."""
    given: dict[str, Any] = {"hardware": "desktop-assumed", "budget_ms": 8.0, "frames": 2}
    scene = lodbench.load_scene("plaza")
    trace = lodbench.load_trace("tour", scene)
    by_number, by_eyes, one = (
        lodbench.replay("full", scene, trace, eyes=eyes, **given)
        for eyes in (0.064, Eyes(apart_m=0.064), None)
    )
    assert by_number.counts.tobytes() == by_eyes.counts.tobytes()
    assert (by_number["draw_calls"] > by_number["drawn"]).all()
    np.testing.assert_array_equal(one["draw_calls"], one["drawn"])


def test_a_study_has_an_axis_of_eyes(tmp_path: Path) -> None:
    """One camera beside two eyes, each by what results call it."""
    path = tmp_path / "eyes.toml"
    path.write_text('eyes = ["none", 0.064]\n[policies]\nfull = {}\n', encoding="utf-8")
    study = read_study(path)
    assert study.axes["eyes"] == (None, "64 mm apart")
    assert [run.options.eyes for run in study.runs()] == [None, Eyes(apart_m=0.064)]
    path.write_text("eyes = 64\n[policies]\nfull = {}\n", encoding="utf-8")
    with pytest.raises(InputError, match="expected metres between the eyes from 0 to 1, got 64"):
        read_study(path)


def test_a_machine_that_draws_refuses_several_cameras() -> None:
    """It would draw and measure one of them, and call it the frame."""
    frame: Any = SimpleNamespace(view=SimpleNamespace(state=SimpleNamespace(rig=object())))
    machine: Any = object()
    with pytest.raises(InputError, match="opengl: expected one camera, got several"):
        GlMachine.run(machine, frame)


def test_a_study_has_players_who_share_a_screen(tmp_path: Path) -> None:
    """A list among the traces is one screen, beside one of its players alone."""
    path = tmp_path / "players.toml"
    head = "[policies]\nfull = {}\n"
    path.write_text(f'traces = ["walk", ["walk", "drive"]]\n{head}', encoding="utf-8")
    study = read_study(path)
    assert study.axes["trace"] == ("walk", "walk + drive")
    shared, alone = (study.inputs[run.trace] for run in reversed(list(study.runs())))
    assert shared.name == "walk-0 + drive-0"
    assert [len(split(path)) for path in (shared, alone)] == [2, 1]
    path.write_text(f'traces = [["walk", "drive"], ["walk", "drive"]]\n{head}', encoding="utf-8")
    with pytest.raises(InputError, match=r"walk \+ drive: expected each once"):
        read_study(path)
    path.write_text(f"traces = [[]]\n{head}", encoding="utf-8")
    with pytest.raises(InputError, match=r"toml:1: traces: expected 1 to 4 players of"):
        read_study(path)


def test_a_gate_has_players_who_share_a_screen() -> None:
    """Two paths are one replay, which costs more than either of them alone, and is hashed anew."""
    plan = CheckPlan(
        policies="full", scenes=("plaza",), traces=("walk",), paths=2, seconds=(0.0, 0.5)
    )
    plan = replace(plan, warmup_s=0.1, budget_ms=8.0)
    sampling = MeasureOptions(seeds=1)
    (_, [alone]), (_, [shared]) = (
        measure_plan(replace(plan, players=players), sampling) for players in (1, 2)
    )
    assert shared.paths == (" + ".join(alone.paths),)
    assert not set(shared.hashes) & set(alone.hashes)
    triangles = alone.values("triangles_mean")
    assert shared.values("triangles_mean")[0, 0] > 1.05 * triangles.max()
