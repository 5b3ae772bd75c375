"""Where cameras move in the bundled scenes: over the ground, through doors, along streets."""

import numpy as np
import pytest

from lodbench.analysis.study.inputs import load_trace
from lodbench.analysis.study.stages import find_stage
from lodbench.models.scene.extent import scene_extent
from lodbench.models.scene.scene import Scene
from lodbench.models.scenes.atlas import build_atlas
from lodbench.models.scenes.soda_hall import build_soda_hall
from lodbench.models.scenes.styria import CELL_M, build_styria, styria_heights


def test_other_scenes_have_the_box_about_them(small_scene: Scene) -> None:
    """Ground at the foot of the box, as large as the box, and no way."""
    middle, size = scene_extent(small_scene)
    stage = find_stage(small_scene)
    assert stage.ground_m == pytest.approx((*middle[:2], middle[2] - size[2] / 2.0))
    assert stage.plan_m == pytest.approx(size[:2])
    assert stage.way_m is None


@pytest.mark.slow
def test_paths_in_the_building() -> None:
    """Walk and drive go the same way through rooms and corridors, the drive ten times as fast."""
    scene, _ = build_soda_hall()
    cells = scene.cells
    assert cells is not None
    walk, drive = load_trace("walk", scene), load_trace("drive", scene)
    assert drive.position_m[:180] == pytest.approx(walk.position_m[:1800:10], abs=1e-6)
    rooms = {cells.cell_at(tuple(point)) for point in drive.position_m.tolist()}
    assert len(rooms) > 5
    assert len(cells.low_m) not in rooms  # never outside
    assert (load_trace("tour", scene).position_m[:, 2] == 1.65).all()


@pytest.mark.slow
def test_paths_over_mountains() -> None:
    """Nothing goes below the ground; on foot and by car the eye keeps its height above it."""
    scene, _ = build_styria()
    heights = styria_heights()
    for kind, low, high in (("walk", 1.0, 2.5), ("drive", 0.8, 2.0), ("fly-over", 500.0, 3_000.0)):
        trace = load_trace(kind, scene)
        x, y, z = trace.position_m.T
        column, row = x / CELL_M, y / CELL_M
        nearest = heights[row.round().astype(int), column.round().astype(int)]
        slope = np.abs(np.diff(heights, axis=0)).max()
        assert (z - nearest).min() > low - slope
        assert (z - nearest).max() < high + slope
    step = np.linalg.norm(np.diff(load_trace("fly-over", scene).position_m, axis=0), axis=1)
    assert 100.0 < step.max() * 60.0 <= 251.0
    for kind in ("tour", "sudden-turn", "orbit"):
        assert load_trace(kind, scene).position_m[:, 2].min() > heights.max()


@pytest.mark.slow
def test_the_detector_stands_on_the_ground() -> None:
    """Eyes are 1.65 m above the floor, not above the foot of a bounding sphere."""
    scene, _ = build_atlas()
    assert load_trace("tour", scene).position_m[0, 2] == pytest.approx(1.65)
