"""`lodbench scene build --continuous`: types of knots in a scene file, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from lodbench.cli.main import run
from lodbench.models.scene.scene_file import read_geometry, read_scene


@pytest.fixture
def ball(tmp_path: Path) -> Path:
    """Return a file of a ball of 1,280 triangles."""
    path = tmp_path / "ball.ply"
    trimesh.creation.icosphere(subdivisions=3).export(path)
    return path


def test_a_scene_of_continuous_types(
    ball: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The file holds six knots with their meshes; the origin says how they were made."""
    out = tmp_path / "balls.lodscene"
    arguments = ["--continuous", "--knots", "6", "--count", "4", "--up", "z"]
    assert run(["scene", "build", str(ball), "--out", str(out), *arguments, "--json"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["origin"]["options"]["knots"] == 6
    scene, geometry = read_scene(out), read_geometry(out)
    levels = scene.types.levels
    assert levels.continuous.tolist() == [True]
    triangles = [len(mesh.faces) for mesh in geometry]
    assert triangles == pytest.approx(np.geomspace(1280, 32, 6), rel=0.05)
    assert (np.diff(levels.error_m) >= 0.0).all()


@pytest.mark.parametrize("knots", ["1", "257"])
def test_knots_out_of_range_are_refused(
    ball: Path, tmp_path: Path, knots: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """One line says what is expected, and no file is written."""
    out = tmp_path / "balls.lodscene"
    arguments = ["--out", str(out), "--continuous", "--knots", knots]
    assert run(["scene", "build", str(ball), *arguments]) == 2
    assert f"knots: expected 2 to 256, got {knots}" in capsys.readouterr().err
    assert not out.exists()
