"""LODManager's scenes: as many objects and triangles as the paper says."""

import numpy as np
import pytest

from lodbench.models.scenes.ogres import build_ogres, build_ogres_trees, ogre_mesh


def test_an_ogre_has_1960_triangles() -> None:
    """Whatever the noise."""
    for seed in range(3):
        assert len(ogre_mesh(np.random.default_rng(seed)).faces) == 1_960


@pytest.mark.slow
def test_ogres() -> None:
    """3,000 of them, continuous, from 1,960 triangles to exactly a tenth, with measured errors."""
    scene, geometry = build_ogres()
    levels = scene.types.levels
    assert len(scene) == 3_000
    assert scene.continuous.all()
    assert levels.counts[0, 2] == 1_960.0
    assert levels.counts[-1, 2] == 196.0
    assert levels.min_resolution.tolist() == [0.1]
    assert 0.0 < levels.error_m[1] < 0.02
    assert (np.diff(levels.error_m) >= 0.0).all()
    assert [len(mesh.faces) for mesh in geometry] == levels.counts[:, 2].astype(int).tolist()
    again, _ = build_ogres()
    assert np.array_equal(again.position_m, scene.position_m)


@pytest.mark.slow
def test_ogres_with_trees() -> None:
    """100 trees of 97,133 triangles beside the ogres; both fall to a tenth."""
    scene, geometry = build_ogres_trees()
    levels = scene.types.levels
    assert np.bincount(scene.type_index).tolist() == [3_000, 100]
    first = int(levels.start[1])
    assert levels.counts[first, 2] == 97_133.0
    assert levels.min_resolution == pytest.approx([0.1, 0.1], abs=1e-3)
    assert len(geometry[first].part_start) == 3  # trunk and leaves
    assert scene.continuous.all()
