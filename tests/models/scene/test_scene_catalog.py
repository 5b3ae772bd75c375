"""Scenes by name or by path."""

from pathlib import Path

import pytest

from lodbench import InputError
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import list_bundled_scenes, load_scene
from lodbench.models.scene.scene_file import write_scene


def test_the_quick_scene_loads_by_its_name() -> None:
    """The plaza is made on the spot; the others have tests of their own."""
    assert "plaza" in list_bundled_scenes()
    assert load_scene("plaza").name == "plaza"
    assert list(list_bundled_scenes()) == sorted(list_bundled_scenes())


def test_paths_load(ball_scene: tuple[Scene, Geometry], tmp_path: Path) -> None:
    """A path is a scene file, whatever its suffix, if it is there."""
    for name in ("balls.lodscene", "balls.zip"):
        write_scene(tmp_path / name, *ball_scene)
        assert load_scene(str(tmp_path / name)).name == "balls"


def test_unknown_names_suggest_the_nearest() -> None:
    """A slip is answered with the name that was meant."""
    with pytest.raises(InputError, match="got palza; did you mean plaza"):
        load_scene("palza")
    with pytest.raises(InputError, match="got zzz; name one of them"):
        load_scene("zzz")


def test_a_missing_file_is_named() -> None:
    """A path with the suffix of scenes is taken as a path."""
    with pytest.raises(InputError, match=r"gone\.lodscene: expected a file, got no such file"):
        load_scene("gone.lodscene")


def test_a_mesh_is_told_from_a_scene(tmp_path: Path) -> None:
    """A scene is made of it first, by the command that is named."""
    (tmp_path / "cow.obj").write_text("v 0 0 0\n")
    with pytest.raises(InputError, match=r"got a mesh; lodbench scene build cow\.obj --out"):
        load_scene(str(tmp_path / "cow.obj"))
