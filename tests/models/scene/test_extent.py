"""The space that a scene takes."""

from dataclasses import replace

import numpy as np
import pytest

from lodbench.models.meshes.geometry import Geometry
from lodbench.models.scene.extent import scene_extent
from lodbench.models.scene.motion import Motion
from lodbench.models.scene.scene import Scene


def test_a_grid_by_hand(ball_scene: tuple[Scene, Geometry]) -> None:
    """The box reaches from the lowest to the highest point of any bounding sphere."""
    scene = ball_scene[0]
    center, size = scene_extent(scene)
    low = (scene.center_m - scene.radius_m[:, None]).min(axis=0)
    high = (scene.center_m + scene.radius_m[:, None]).max(axis=0)
    assert center - size / 2 == pytest.approx(low)
    assert center + size / 2 == pytest.approx(high)


def test_moving_objects_stay_inside(ball_scene: tuple[Scene, Geometry]) -> None:
    """At any time every moving sphere is in the box, and comes to its edge."""
    motion = Motion(
        np.array([0, 19], dtype=np.int32),
        np.array([30.0, 50.0]),
        np.array([1.0, -0.3]),
        np.array([0.4, 2.0]),
    )
    scene = replace(ball_scene[0], motion=motion)
    center, size = scene_extent(scene)
    slack = np.inf
    for time_s in np.linspace(0.0, 50.0, 2_001):
        moved = scene.center_m[motion.node]
        moved[:, :2] += motion.offset_m(float(time_s)).T
        reach = np.abs(moved - center) + scene.radius_m[motion.node][:, None]
        slack = min(slack, float((size / 2 - reach)[:, :2].min()))
    assert 0.0 <= slack < 0.01
