"""How much of its disc a mesh covers: shapes whose silhouettes are known."""

import numpy as np
import pytest
import trimesh

from lodbench.models.meshes.geometry import LevelMesh
from lodbench.models.meshes.silhouette import disc_share


def level(mesh: trimesh.Trimesh) -> LevelMesh:
    """Return a mesh of trimesh as a level."""
    faces = np.asarray(mesh.faces, dtype=np.int32)
    normals = np.asarray(mesh.vertex_normals, dtype=np.float32)
    return LevelMesh(
        np.asarray(mesh.vertices, dtype=np.float32), normals, faces, np.array([0, len(faces)])
    )


def test_a_ball_covers_its_disc() -> None:
    """A sphere covers all of its disc, but for the width of a cell at its rim."""
    ball = level(trimesh.creation.icosphere(subdivisions=4, radius=2.0))
    assert disc_share(ball, np.zeros(3), 2.0) == pytest.approx(1.0, abs=0.06)


def test_a_box_covers_what_its_faces_do() -> None:
    """The silhouette of a convex box is the sum of its faces' areas times their cosines."""
    size, radius = np.array([2.0, 1.0, 3.0]), np.sqrt(14.0) / 2.0
    box = level(trimesh.creation.box(extents=size))
    shares: list[float] = []
    for step in range(12):
        azimuth, elevation = 2.0 * np.pi * step / 12, np.radians((0.0, 10.0, 25.0)[step % 3])
        direction = np.array((
            np.cos(azimuth) * np.cos(elevation), np.sin(azimuth) * np.cos(elevation),
            np.sin(elevation),
        ))  # fmt: skip
        faces = np.array((size[1] * size[2], size[0] * size[2], size[0] * size[1]))
        shares.append(float(faces @ np.abs(direction)) / (np.pi * radius**2))
    assert disc_share(box, np.zeros(3), radius) == pytest.approx(np.mean(shares), rel=0.08)


def test_a_pole_covers_little() -> None:
    """A pole forty times as long as thick covers about the cells that it stands in."""
    pole = level(trimesh.creation.cylinder(radius=0.02, height=1.6))
    assert disc_share(pole, np.zeros(3), 0.8) < 0.1


def test_a_mesh_without_area_is_a_few_points() -> None:
    """Degenerate triangles cover the cells of their corners, and are no error."""
    flat = LevelMesh(
        np.array([(0, 0, 0), (0, 0, 0.5), (0, 0, 1)], np.float32), np.zeros((3, 3), np.float32),
        np.array([(0, 1, 2)], np.int32), np.array([0, 1]),
    )  # fmt: skip
    assert 0.0 < disc_share(flat, np.array([0.0, 0.0, 0.5]), 0.5) < 0.01
