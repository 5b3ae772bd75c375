"""Fixtures of commands that draw: scenes of balls, and `lodbench record` of them."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from lodbench.cli.main import run
from lodbench.models.scene.scene_file import read_geometry, read_scene, write_scene

QUICK = ["--trace", "walk", "--repeats", "1", "--size", "160x90", "--seconds", "0:0.05"]


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Build 80 balls of two types, the same as a tree, and the same without meshes."""
    folder = tmp_path_factory.mktemp("scenes")
    names = [str(folder / f"{name}.ply") for name in ("ball", "small")]
    for name, subdivisions in zip(names, (3, 2), strict=True):
        trimesh.creation.icosphere(subdivisions=subdivisions).export(name)
    flat = folder / "balls.lodscene"
    options = ["--layout", "grid", "--count", "80", "--levels", "4", "--json"]
    assert run(["scene", "build", *names, "--out", str(flat), *options]) == 0
    scene, parent = read_scene(flat), np.zeros(80, dtype=np.int32)
    parent[0] = -1
    write_scene(folder / "tree.lodscene", replace(scene, parent=parent), read_geometry(flat))
    write_scene(folder / "bare.lodscene", scene, ())
    return folder


@pytest.fixture
def record(
    scenes: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> Callable[..., int]:
    """Return a function that records in an empty folder, of the balls unless told."""
    monkeypatch.chdir(tmp_path)
    capsys.readouterr()

    def command(*more: str, out: str = "log.csv", scene: str = "balls") -> int:
        named = str(scenes / f"{scene}.lodscene")
        return run(["record", "--scene", named, "--out", out, *QUICK, *more])

    return command
