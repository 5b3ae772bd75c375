"""The city at full size: blocks, nodes, depths and triangles as printed."""

import numpy as np
import pytest

from lodbench.models.scene.tree import Tree
from lodbench.models.scenes.city import TRIANGLES, build_city, street_route_m


@pytest.mark.slow
def test_the_city() -> None:
    """114 blocks, about 2,296 nodes of depth at most 5, 8,950,000 triangles, plain and textured."""
    scene, geometry = build_city()
    tree = Tree(scene)
    levels = scene.types.levels
    assert len(scene.roots) == 114
    assert abs(len(scene) - 2_296) <= 10
    assert tree.depth.max() + 1 == 5
    counts = levels.counts[scene.type_index]
    assert counts[tree.leaf, 2].sum() == TRIANGLES == 8_950_000
    textured = counts[tree.leaf, 4].sum() / TRIANGLES
    assert 0.8 < textured < 0.99
    assert counts[tree.leaf, 6].sum() == pytest.approx(937e6 * 16.0 / 3.0)
    assert len(geometry) == len(levels.error_m)
    error = levels.error_m[scene.type_index]
    child = np.flatnonzero(scene.parent >= 0)
    assert (error[scene.parent[child]] >= error[child]).all()
    assert (error[tree.leaf] == 0.0).all()
    assert (np.bincount(scene.parent[child], minlength=len(scene))[~tree.leaf] == 4).all()
    # Nobody walks into a wall: the way along the streets keeps clear of all leaves' spheres.
    steps = np.concatenate(
        [
            a + np.linspace(0.0, 1.0, 50)[:, None] * (b - a)
            for a, b in zip(street_route_m(), street_route_m()[1:], strict=False)
        ]
    )
    leaf = np.flatnonzero(tree.leaf)
    gap = np.linalg.norm(steps[:, None] - scene.center_m[leaf, :2], axis=2)
    assert gap.min() > 5.0
