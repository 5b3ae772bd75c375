"""The cows: as many triangles as the paper's mesh, all on the plane."""

import numpy as np
import pytest

from lodbench.models.scenes.cows import build_cows, cow_mesh


def test_a_cow_has_5804_triangles() -> None:
    """Whatever the noise."""
    for seed in range(3):
        assert len(cow_mesh(np.random.default_rng(seed)).faces) == 5_804


@pytest.mark.slow
def test_cows() -> None:
    """400 of them, continuous, with measured errors, 2.3 million triangles, twice the same."""
    scene, geometry = build_cows()
    levels = scene.types.levels
    assert len(scene) == 400
    assert scene.continuous.all()
    assert len(scene) * levels.counts[0, 2] == 2_321_600.0
    assert levels.counts[-1, 2] == 58.0
    assert 0.0 < levels.error_m[1] < 0.02
    assert (np.diff(levels.error_m) >= 0.0).all()
    assert [len(mesh.faces) for mesh in geometry] == levels.counts[:, 2].astype(int).tolist()
    assert np.ptp(scene.position_m[:, 2]) == 0.0
    again, _ = build_cows()
    assert np.array_equal(again.position_m, scene.position_m)
