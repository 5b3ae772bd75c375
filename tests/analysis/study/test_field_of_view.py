"""The field of view that a path's file states is that of its replays, unless another is told."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import lodbench
from lodbench.analysis.study.field_of_view import field_of_view, whose_field_of_view
from lodbench.base.errors import InputError
from lodbench.cli.main import run
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate

STATED_DEG = 35.0


def path_of(name: str, fovy_deg: float | None = None) -> CameraTrace:
    """Return a short path that states this field of view."""
    return replace(generate("orbit", duration_s=1.0), name=name, fovy_deg=fovy_deg)


def nerfstudio(folder: Path) -> Path:
    """Return a path of 3 s above the bundled scenes' ground, which states 35 degrees."""
    level = [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1]
    shots = [
        {"camera_to_world": [*level[:3], 0.2 * i, *level[4:]], "fov": STATED_DEG, "aspect": 1.5}
        for i in range(31)
    ]
    path = folder / "shot.json"
    path.write_text(json.dumps({"camera_path": shots, "fps": 10, "seconds": 3}))
    return path


def test_what_is_told_comes_before_what_paths_state() -> None:
    """Told, else stated, else 60 degrees; a path that states nothing goes along."""
    stated, silent = path_of("a", STATED_DEG), path_of("b")
    assert field_of_view([stated, silent], 50.0) == 50.0
    assert field_of_view([silent, stated]) == STATED_DEG
    assert field_of_view([silent]) == 60.0
    assert whose_field_of_view([silent, stated], STATED_DEG) == "as a states it"
    assert whose_field_of_view([silent, stated], 50.0) == "in place of 35 of a"
    assert whose_field_of_view([silent], 50.0) == ""


def test_paths_that_state_different_ones_are_asked_about() -> None:
    """One comparison has one lens: which, the user says."""
    paths = [path_of("a", STATED_DEG), path_of("b", 70.0)]
    with pytest.raises(InputError, match=r"35 degrees in a and 70 in b; .*--fovy-deg 35"):
        field_of_view(paths)
    assert field_of_view(paths, 70.0) == 70.0


def test_a_replay_is_seen_through_the_stated_lens() -> None:
    """A path that states 35 degrees is replayed as one that is told 35, and not as 60."""
    given: dict[str, Any] = {"hardware": "desktop-assumed", "budget_ms": 4.0}
    stated = lodbench.replay("static-screen", "cows", path_of("p", STATED_DEG), **given)
    told = lodbench.replay("static-screen", "cows", path_of("p"), fovy_deg=STATED_DEG, **given)
    usual = lodbench.replay("static-screen", "cows", path_of("p"), **given)
    assert stated["triangles"].tolist() == told["triangles"].tolist()
    assert stated["triangles"].tolist() != usual["triangles"].tolist()


def test_runs_of_a_study_have_the_lens_of_their_path() -> None:
    """Without an axis each path has its own; with one, None stands for that."""
    paths = {"tele": path_of("tele", STATED_DEG), "plain": path_of("plain")}
    alone = lodbench.Study("full", scenes="cows", traces=paths, warmup_s=0.0)
    assert [run.options.fovy_deg for run in alone.runs()] == [STATED_DEG, 60.0]
    both = lodbench.Study("full", scenes="cows", traces=paths, fovy_deg=[None, 50], warmup_s=0.0)
    assert sorted(run.options.fovy_deg for run in both.runs()) == [STATED_DEG, 50.0, 50.0, 60.0]
    cells = {(case.cells["trace"], case.cells["fovy_deg"]) for case in both.cases()}
    assert cells == {("tele", STATED_DEG), ("tele", 50), ("plain", 60.0), ("plain", 50)}


@pytest.mark.slow
def test_compare_says_whose_lens_it_takes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A line on stderr and the conditions of the record say it; told, it stands in place of it."""
    words = ["compare", "--scene", "cows", "--trace", str(nerfstudio(tmp_path)), "--as-shipped"]
    words += ["--policy", "static-screen", "--seeds", "1", "--workers", "1", "--json"]
    for more, degrees, whose in (
        ([], STATED_DEG, "as shot states it"),
        (["--fovy-deg", "50"], 50.0, "in place of 35 of shot"),
    ):
        assert run([*words, *more]) == 0
        out, err = capsys.readouterr()
        assert f"note: field of view of {degrees:g} degrees, {whose}" in err
        conditions = json.loads(out)["conditions"]
        assert (conditions["fovy_deg"], conditions["fovy_of"]) == (degrees, whose)


@pytest.mark.slow
def test_check_judges_through_the_stated_lens(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The baseline is of 35 degrees, so that a check at another is refused."""
    limits = tmp_path / "limits.toml"
    limits.write_text('[limits]\nwork_ms_p99 = { max_increase = "5%", population = "this-path" }\n')
    words = ["check", "--scene", "cows", "--trace", str(nerfstudio(tmp_path)), "--limits"]
    words += [str(limits), "--baseline", str(tmp_path / "b.json"), "--policy", "static-screen"]
    words += ["--workers", "1", "--seeds", "2", "--budget-ms", "2"]
    assert run([*words, "--update-baseline"]) == 0
    stored = json.loads((tmp_path / "b.json").read_text())
    assert stored["conditions"]["fovy_deg"] == STATED_DEG
    assert run(words) == 0
    capsys.readouterr()
    assert run([*words, "--fovy-deg", "60"]) == 2
    assert "expected a baseline of fovy_deg 60.0, got 35.0" in capsys.readouterr().err
