"""The detector: hundreds of parts, millions of triangles, a wide range of sizes."""

import numpy as np
import pytest

from lodbench.models.scene.benefit import level_primitives
from lodbench.models.scenes.atlas import build_atlas


@pytest.mark.slow
def test_the_detector() -> None:
    """Sizes 100 times apart, nested about the beam, all continuous and above the ground."""
    scene, geometry = build_atlas()
    levels = scene.types.levels
    full = level_primitives(levels)[levels.start[:-1]][scene.type_index]
    assert 500 < len(scene) < 2_000
    assert 2e6 < full.sum() < 6e6
    assert scene.continuous.all()
    assert scene.radius_m.max() / scene.radius_m.min() > 100.0
    out = np.hypot(scene.center_m[:, 1], scene.center_m[:, 2] - 13.0)
    assert out.max() < 13.0
    assert len(geometry) == len(levels.error_m)
