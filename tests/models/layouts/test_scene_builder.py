"""Scenes from types and a layout."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench import InputError
from lodbench.models.layouts.placement import LAYOUTS
from lodbench.models.layouts.scene_builder import PlacementOptions, build_scene
from lodbench.models.meshes.geometry import Geometry
from lodbench.models.meshes.type_model import TypeModel
from lodbench.models.scene.extent import scene_extent
from lodbench.models.scene.scene import Scene

Build = Callable[[PlacementOptions, int], Scene]


@pytest.fixture(scope="module")
def build(ball_models: list[TypeModel]) -> Build:
    """Return what builds a scene of balls and pebbles from options and a seed."""

    def build_balls(options: PlacementOptions, seed: int) -> Scene:
        return build_scene("scene", ball_models, options, np.random.default_rng(seed))[0]

    return build_balls


@pytest.mark.slow
@settings(max_examples=50, deadline=None)
@given(
    layout=st.sampled_from(sorted(LAYOUTS)),
    count=st.integers(1, 80),
    spacing=st.floats(0.0, 3.0),
    variation=st.floats(0.0, 0.9),
    seed=st.integers(0, 2**32),
)
def test_scenes_hold_what_was_asked_for(
    build: Build,
    layout: str,
    count: int,
    spacing: float,
    variation: float,
    seed: int,
) -> None:
    """Count, shares of types, scales, spacing in plan, ground and extent are as asked."""
    options = PlacementOptions(layout, count, spacing, scale_variation=variation)
    scene = build(options, seed)
    assert len(scene) == count
    assert np.ptp(np.bincount(scene.type_index, minlength=2)) <= 1
    assert (
        np.abs(scene.scale - 1.0) <= variation + 1e-15
    ).all()  # scales are near 1, where that rounds
    first, second = np.triu_indices(count, k=1)
    distance = np.linalg.norm((scene.center_m[first] - scene.center_m[second])[:, :2], axis=1)
    gap = distance - scene.radius_m[first] - scene.radius_m[second]
    assert gap.min(initial=np.inf) >= spacing - 1e-6
    assert (scene.position_m[:, 2] == 0.0).all()
    center, size = scene_extent(scene)
    outside = np.abs(scene.center_m - center) + scene.radius_m[:, None] - size / 2.0
    assert outside.max() <= 1e-9


def test_the_seed_decides(build: Build) -> None:
    """The same seed gives the same scene, another seed another one."""
    options = PlacementOptions(count=50)
    one, two, other = (build(options, seed) for seed in (1, 1, 2))
    assert np.array_equal(one.position_m, two.position_m)
    assert np.array_equal(one.orientation_xyzw, two.orientation_xyzw)
    assert not np.array_equal(one.position_m, other.position_m)


def test_yaw_can_be_off(build: Build) -> None:
    """Without random yaw all objects face alike; with it they turn about z only."""
    still = build(PlacementOptions(random_yaw=False), 0)
    assert (still.orientation_xyzw == (0, 0, 0, 1)).all()
    turned = build(PlacementOptions(), 0).orientation_xyzw
    assert (turned[:, :2] == 0).all()
    assert np.std(turned[:, 2]) > 0.5


def test_side_bounds_the_scene(build: Build) -> None:
    """With a side, every bounding sphere stands inside the square."""
    scene = build(PlacementOptions(count=100, side_m=60.0), 0)
    assert (np.abs(scene.center_m[:, :2]).max(axis=1) + scene.radius_m).max() <= 30.0 + 1e-6


@pytest.mark.parametrize(
    ("layout", "count", "variation"),
    [("circle", 10, 0.0), ("grid", 0, 0.0), ("grid", 10**8, 0.0), ("grid", 10, 1.0)],
)
def test_options_out_of_range_are_refused(layout: str, count: int, variation: float) -> None:
    """Options that no scene can follow are input errors before any work."""
    with pytest.raises(InputError, match="expected"):
        PlacementOptions(layout, count, scale_variation=variation)


def test_geometry_goes_with_the_levels(ball_scene: tuple[Scene, Geometry]) -> None:
    """Each row of the level table has the mesh with its triangles, vertices and bytes."""
    scene, geometry = ball_scene
    levels = scene.types.levels
    assert levels.start.tolist() == [0, 3, 5]
    assert [len(mesh.faces) for mesh in geometry] == levels.counts[:, 2].tolist()
    assert [len(mesh.vertices) for mesh in geometry] == levels.counts[:, 1].tolist()
    assert [mesh.byte_count for mesh in geometry] == levels.bytes.tolist()
