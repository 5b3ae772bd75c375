"""Materials and texture coordinates of simplified meshes."""

import numpy as np

from lodbench.base.arrays import IntArray
from lodbench.models.meshes.attributes import carry_parts, carry_uv
from lodbench.models.meshes.geometry import Float32Array
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.simplify import ChainOptions, build_chain, simplify_surface
from lodbench.models.meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface

SIDES, RINGS = 48, 24


def tube() -> SurfaceMesh:
    """Return a tube about z whose u runs once round and jumps from 1 to 0 at a seam."""
    u, v = np.meshgrid(np.linspace(0, 1, SIDES + 1), np.linspace(0, 1, RINGS + 1), indexing="ij")
    angle = 2 * np.pi * np.where(u == 1.0, 0.0, u)
    points = np.stack((np.cos(angle), np.sin(angle), 4 * v), axis=-1).reshape(-1, 3)
    corner = np.add.outer(np.arange(SIDES) * (RINGS + 1), np.arange(RINGS)).ravel()
    below = corner + RINGS + 1
    faces = np.concatenate(
        (
            np.stack((corner, below, below + 1), 1),
            np.stack((corner, below + 1, corner + 1), 1),
        )
    )
    return clean_surface(
        "tube", [MeshPart(points, faces, textured=True, uv=np.stack((u, v), -1).reshape(-1, 2))]
    )


def spans(uv: Float32Array, faces: IntArray) -> Float32Array:
    """Return how much of the texture's width each face takes."""
    return np.ptp(uv[faces][..., 0], axis=1)


def test_full_level_keeps_its_seam() -> None:
    """The full tube has its two columns of seam vertices, and no face across the texture."""
    mesh = build_chain(tube(), ChainOptions(levels=1), Sampling()).meshes[0]
    assert len(mesh.vertices) == (SIDES + 1) * (RINGS + 1)
    assert mesh.uv is not None
    assert spans(mesh.uv, mesh.faces).max() < 1.5 / SIDES


def test_coarse_level_stays_on_its_side_of_the_seam() -> None:
    """Most faces of a coarse tube take as much texture as they go round, beside a seam too."""
    full = tube()
    points, faces = simplify_surface(full.positions, full.faces, len(full.faces) // 4)
    index = carry_uv(full, points, faces, np.zeros(len(faces), dtype=np.int32))
    width = np.ptp(full.uv[index][..., 0], axis=1)
    assert (width < 0.5).mean() > 0.98
    # Where no seam is near, the coordinate is that of the angle.
    angle = np.arctan2(points[:, 1], points[:, 0]) / (2 * np.pi) % 1.0
    away = (np.abs(angle - 0.5) < 0.4)[faces]
    assert np.abs(full.uv[index][..., 0] - angle[faces])[away].max() < 2.0 / SIDES


def test_parts_keep_their_place() -> None:
    """The two coloured ends of a tube stay two colours at the same height when simplified."""
    whole = tube()
    upper = whole.positions[whole.faces][..., 2].mean(axis=1) > 2.0
    parts = [
        MeshPart(whole.positions, whole.faces[mask].astype(np.int64), material=i)
        for i, mask in enumerate((~upper, upper))
    ]
    full = clean_surface("two", parts)
    points, faces = simplify_surface(full.positions, full.faces, len(full.faces) // 4)
    part = carry_parts(full, points, faces)
    height = points[faces][..., 2].mean(axis=1)
    assert height[part == 0].max() < 2.4
    assert height[part == 1].min() > 1.6
