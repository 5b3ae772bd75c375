"""Peng's crowd: vertices, triangles, skin and texture of a character, and where they stand."""

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.meshes.level_mesh import level_mesh
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.models.scenes.crowd import build_crowd, character_mesh, walking_poses


def test_a_character_as_in_table_1() -> None:
    """1,642 vertices with seams, 2,620 triangles; closed in space, cut open in the texture."""
    mesh = character_mesh()
    drawn = level_mesh(mesh)
    assert (len(drawn.vertices), len(drawn.faces)) == (1_642, 2_620)
    ends = np.sort(np.stack((mesh.faces, np.roll(mesh.faces, -1, 1)), 2).reshape(-1, 2), 1)
    assert (np.unique(ends, axis=0, return_counts=True)[1] == 2).all()
    assert len(mesh.positions) == 2_620 // 2 + 2 * 6  # Euler: six closed pieces
    assert mesh.uv.min() >= 0.0
    assert mesh.uv.max() <= 1.0


@pytest.mark.parametrize("count", [32, 1_000])
def test_crowds(count: int) -> None:
    """As many as named, all of one skinned, textured, continuous type, no two in one place."""
    scene, _ = build_crowd(count)
    assert scene.name == f"crowd-{count}"
    assert len(scene) == count
    levels = scene.types.levels
    vertices, triangles, skinned, textured = levels.counts[:, [1, 2, 3, 4]].T
    assert (vertices[0], triangles[0]) == (1_642.0, 2_620.0)
    assert (skinned == vertices).all()
    assert (textured == triangles).all()
    assert triangles[-1] == 190.0  # the coarsest of Fig. 3
    gap = scene.position_m[:32, None, :2] - scene.position_m[None, :32, :2]
    assert (np.linalg.norm(gap, axis=2) + 9.0 * np.eye(32)).min() > 0.6


def test_poses_of_a_stride() -> None:
    """Body and head stand still, arms swing against legs, and left and right change places."""
    mesh = character_mesh()
    poses = walking_poses(mesh)
    assert poses.shape == (8, len(mesh.positions), 3)
    x, y, z = mesh.positions.T
    still = np.abs(poses - mesh.positions).max(axis=(0, 2)) < 1e-12
    assert still[z > 1.55].all()
    foot = [np.flatnonzero((np.sign(x) == side) & (z < 0.1)) for side in (-1, 1)]
    hand = [np.flatnonzero((x * side > 0.27) & (z < 0.85)) for side in (-1, 1)]
    ahead = poses[:, :, 1] - y
    left, right = (ahead[:, at].mean(axis=1) for at in foot)
    arm = ahead[:, hand[0]].mean(axis=1)
    assert left[2] * right[2] < 0.0 < left[2] * left[2]
    assert left[2] * arm[2] < 0.0
    assert left == pytest.approx(np.roll(right, 4), abs=0.02)


@pytest.mark.parametrize("name", ["crowd-31", "crowd-32769", "crowd-9999999999"])
def test_crowds_of_other_sizes_are_refused(name: str) -> None:
    """With the numbers that can be had."""
    with pytest.raises(InputError, match="32 to 32768 characters"):
        load_scene(name)


@pytest.mark.parametrize("name", ["crowd-", "crowd-x", "crowd-032", "crowd"])
def test_what_is_no_crowd_is_an_unknown_name(name: str) -> None:
    """The nearest name is suggested."""
    with pytest.raises(InputError, match="crowd-1024"):
        load_scene(name)
