"""Levels that artists made: which files belong together, and what becomes of them."""

from pathlib import Path

import pytest
import trimesh

from lodbench.base.errors import InputError
from lodbench.models.meshes.authored_levels import group_levels
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_types import MeshUnits, read_types
from lodbench.models.meshes.simplify import ChainOptions


def paths(*names: str) -> list[Path]:
    """Return names as paths."""
    return [Path(name) for name in names]


def test_files_are_levels_by_their_names() -> None:
    """As Unity, Unreal, Godot and Blender call them; a file alone is a type of its own."""
    given = paths("rock_LOD1.obj", "tree.obj", "rock_LOD0.obj", "oak-lod0.ply", "oak-lod1.ply")
    groups = group_levels([*given, Path("lamp_LOD0.obj")])
    assert [(group.name, [path.name for path in group.paths]) for group in groups] == [
        ("rock", ["rock_LOD0.obj", "rock_LOD1.obj"]),
        ("tree", ["tree.obj"]),
        ("oak", ["oak-lod0.ply", "oak-lod1.ply"]),
        ("lamp_LOD0", ["lamp_LOD0.obj"]),
    ]


@pytest.mark.parametrize("names", [("a_LOD0.obj", "a_LOD2.obj"), ("a_LOD3.obj", "a_LOD4.obj")])
def test_a_missing_level_is_refused(names: tuple[str, ...]) -> None:
    """A gap in the numbers is a forgotten file, not a chain."""
    with pytest.raises(InputError, match="one after the other from LOD0"):
        group_levels(paths(*names))


def balls(folder: Path, *subdivisions: int) -> list[Path]:
    """Write balls of radius 1 about (0, 3, 0) as levels, and return their paths."""
    found: list[Path] = []
    for level, count in enumerate(subdivisions):
        ball = trimesh.creation.icosphere(subdivisions=count)
        ball.apply_translation((0.0, 3.0, 0.0))
        found.append(folder / f"ball_LOD{level}.ply")
        ball.export(found[-1])
    return found


def test_levels_keep_their_triangles_and_stand_as_the_finest_does(tmp_path: Path) -> None:
    """320, 80 and 20 triangles; a coarse ball, which is smaller, is not stretched to the height."""
    groups = group_levels(balls(tmp_path, 2, 1, 0))
    (model,) = read_types(groups, MeshUnits(height_m=4.0), ChainOptions(), Sampling())
    assert model.name == "ball"
    assert [len(mesh.faces) for mesh in model.meshes] == [320, 80, 20]
    heights = [
        float(mesh.vertices[:, 2].max() - mesh.vertices[:, 2].min()) for mesh in model.meshes
    ]
    assert heights[0] == pytest.approx(4.0, abs=1e-6)
    assert heights[2] < 4.0
    assert model.error_m[0] == 0.0
    # An icosahedron in a ball of radius 2 m lies up to 0.41 m below it.
    assert 0.2 < model.error_m[2] < 0.45
    assert model.error_m[1] < model.error_m[2]


def test_levels_in_the_wrong_order_are_refused(tmp_path: Path) -> None:
    """A coarser level with more triangles than the finer one names its file."""
    groups = group_levels(balls(tmp_path, 1, 2))
    with pytest.raises(InputError, match=r"LOD1\.ply: expected fewer than the 80 triangles"):
        list(read_types(groups, MeshUnits(), ChainOptions(), Sampling(10, 10)))


def test_with_its_origin_kept_a_mesh_stays_where_it_is(tmp_path: Path) -> None:
    """Placements of an engine count from the file's origin: the ball stays 3 m above it."""
    (group,) = group_levels(balls(tmp_path, 1))
    units = MeshUnits(unit_m=0.5, keep_origin=True)
    (model,) = read_types([group], units, ChainOptions(), Sampling(10, 10))
    assert model.center_m == pytest.approx((0.0, 0.0, 1.5), abs=1e-6)
