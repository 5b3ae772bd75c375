"""Levels of detail of real meshes: closed, open, non-manifold, of several parts."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.models.meshes.authored_levels import group_levels
from lodbench.models.meshes.mesh_error import ErrorMeter, Sampling
from lodbench.models.meshes.mesh_file import load_mesh
from lodbench.models.meshes.mesh_types import MeshUnits, read_types
from lodbench.models.meshes.simplify import ChainOptions, build_chain, simplify_surface

pytestmark = pytest.mark.realdata

MESHES = (
    "CesiumMilkTruck.glb",
    "cow.obj",
    "fandisk.obj",
    "homer.obj",
    "rocker-arm.obj",
    "spot.obj",
    "stanford-bunny.obj",
    "suzanne.obj",
    "teapot.obj",
)


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
def test_errors_are_sane(name: str, data_dir: Path) -> None:
    """Each mesh, 2 m tall, has a chain whose error rises from 0 and stays below its radius."""
    path = data_dir / "meshes" / name
    (model,) = read_types(group_levels([path]), MeshUnits(), ChainOptions(), Sampling())
    triangles = model.counts[:, 2]
    assert len(triangles) >= 4
    assert (np.diff(triangles) < 0).all()
    assert model.error_m[0] == 0.0
    assert (model.error_m[1:] > 0.0).all()
    assert model.error_m[-1] < model.radius_m
    height = np.ptp(model.meshes[0].vertices[:, 2])
    assert height == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "vertices", "triangles"),
    [
        ("cow.obj", 2_903, 5_804),  # Gobbetti and Bouvier's test meshes, as they print them
        ("fandisk.obj", 6_475, 12_946),
        ("stanford-bunny.obj", 35_947, 69_451),
    ],
)
def test_counts_are_the_published_ones(
    name: str, vertices: int, triangles: int, data_dir: Path
) -> None:
    """Nothing is lost in reading; the bunny has 1,113 vertices that no triangle uses."""
    mesh = load_mesh(data_dir / "meshes" / name)
    assert len(mesh.faces) + mesh.dropped == triangles
    assert len(mesh.positions) == vertices - (1_113 if name == "stanford-bunny.obj" else 0)


def test_truck_has_parts_and_textures(data_dir: Path) -> None:
    """Four materials, two of them textured by one image of 2048², two axles of one geometry."""
    mesh = load_mesh(data_dir / "meshes" / "CesiumMilkTruck.glb")
    assert sorted(np.bincount(mesh.part).tolist()) == [56, 288, 1536, 1744]
    assert sorted(np.bincount(mesh.part)[mesh.textured].tolist()) == [1536, 1744]
    assert mesh.texture_bytes == pytest.approx(2048**2 * 4 * 4 / 3)


@pytest.mark.slow
def test_error_agrees_with_dense_sampling(data_dir: Path) -> None:
    """The default samples find at least 85 % of what four times as many points find."""
    full = load_mesh(data_dir / "meshes" / "spot.obj").standing(y_up=True, height_m=2.0)
    quick = ErrorMeter(full.positions, full.faces, Sampling())
    dense = ErrorMeter(full.positions, full.faces, Sampling(surface=40_000, seed=1))
    for target in (2_928, 366):
        level = simplify_surface(full.positions, full.faces, target)
        assert quick.error_m(*level) >= 0.85 * dense.error_m(*level)


def test_seams_survive_in_the_vertex_count(data_dir: Path) -> None:
    """Spot is drawn with the 3,225 corners of position and coordinate that its file lists."""
    full = load_mesh(data_dir / "meshes" / "spot.obj")
    model = build_chain(full, ChainOptions(levels=2), Sampling(100, 100))
    assert len(full.positions) == 2_930
    assert len(model.meshes[0].vertices) == 3_225
    assert model.meshes[1].uv is not None
