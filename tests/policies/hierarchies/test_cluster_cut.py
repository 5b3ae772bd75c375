"""Cluster cuts: each node decides alone, together they are a front; and the steered tolerance."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.tree import Tree
from lodbench.policies.hierarchies.cluster_cut import ClusterCut

Make = Callable[..., Any]
AHEAD = (0.5, -0.5, -0.5, 0.5)  # along x, z up


@settings(max_examples=40, deadline=None)
@given(x_m=st.floats(-55.0, 165.0), tolerance_px=st.floats(0.3, 60.0))
def test_a_front_wherever_the_camera_is(
    city: Scene, make_tree_view: Make, x_m: float, tolerance_px: float
) -> None:
    """Every leaf in view is covered once, by a node within the tolerance unless it is a leaf."""
    policy = ClusterCut(tolerance_px=tolerance_px)
    policy.reset(city, 16.0)
    camera = Camera((x_m, 55.0, 1.7), AHEAD, 1280, 1024, np.pi / 3)
    view = make_tree_view(city, camera)
    ids = policy.select(view).ids
    tree = Tree(city)
    assert tree.drawn_twice(ids) == -1
    leaves = np.flatnonzero(tree.leaf & view.state.inside)
    assert (tree.cover(ids)[leaves] >= 0).all()
    seen = view.at(ids)
    error_px = seen.camera.focal_px * city.types.levels.error_m[ids] / seen.nearest_m
    assert (error_px <= tolerance_px + 1e-9).all()


def test_errors_that_grow_downwards_are_raised_above(
    make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """A root that claims less error than its child is refined where the child would be."""
    levels = make_levels([[10.0], [40.0], [90.0]], error_m=[[0.1], [0.5], [0.0]])
    scene = make_scene([(0.0, 0.0, -11.0)] * 3, kind=[0, 1, 2], parent=[-1, 0, 1], levels=levels)
    # 50 px a metre at 1 m: at 10 m the errors are 0.5, 2.5 and 0 px.
    for tolerance_px, expected in ((1.0, [2]), (3.0, [0])):
        policy = ClusterCut(tolerance_px=tolerance_px)
        policy.reset(scene, 16.0)
        assert policy.select(make_tree_view(scene)).ids.tolist() == expected


def _steered(policy: ClusterCut, scene: Scene, view: Make, reports: Sequence[float]) -> float:
    for count in range(1, len(reports) + 1):
        policy.select(view(scene, work_ms=reports[:count]))
    return policy._steered_px  # pyright: ignore[reportPrivateUsage] - levels are too coarse


@pytest.fixture
def scene(make_scene: Make, make_levels: Make) -> Scene:
    """Return a root and its child."""
    levels = make_levels([[10.0], [40.0]], error_m=[[0.1], [0.0]])
    return make_scene([(0.0, 0.0, -11.0)] * 2, kind=[0, 1], parent=[-1, 0], levels=levels)


@pytest.mark.parametrize(
    ("reports", "expected"),
    [
        ([9.4], 1.0),  # within 5 % of the target of 9 ms
        ([9.9], (9.9 / 9.0) ** 0.5),
        ([90.0], 1.1),  # at most 10 % a frame
        ([90.0, 91.0], 1.21),
        ([90.0, 1.0], 1.0),
        ([1.0], 1.0),  # never below the tolerance
        ([90.0] * 60, 64.0),  # nor above the largest; a repeated report over the target counts
    ],
)
def test_tolerance_follows_the_root_of_time_over_target(
    scene: Scene, make_tree_view: Make, reports: list[float], expected: float
) -> None:
    """Each report multiplies it by (time / 9 ms)^0.5, within the limits."""
    policy = ClusterCut()
    policy.reset(scene, 10.0)
    assert _steered(policy, scene, make_tree_view, reports) == pytest.approx(expected)


@pytest.mark.parametrize("fault", [float("nan"), 0.0, -3.0])
def test_faulty_times_do_not_raise_detail(scene: Scene, make_tree_view: Make, fault: float) -> None:
    """A report that is no time leaves the tolerance where it was."""
    policy = ClusterCut()
    policy.reset(scene, 10.0)
    assert _steered(policy, scene, make_tree_view, [90.0, fault, fault]) == pytest.approx(1.1)


def test_flat_scenes_take_the_coarsest_level_within_the_tolerance(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """At 10 m and 50 px a metre, 1 px allows 0.2 m."""
    levels = make_levels([[900.0, 300.0, 100.0]], error_m=[[0.0, 0.19, 0.21]])
    flat = make_scene([(0.0, 0.0, -11.0)], levels=levels)
    policy = ClusterCut()
    policy.reset(flat, 10.0)
    assert policy.select(make_view(flat)).detail.tolist() == [1.0]


@pytest.mark.parametrize(
    "wrong", [{"tolerance_px": 0.0}, {"max_px": 0.5}, {"rate_limit": 0.9}, {"gain": -1.0}]
)
def test_refuses_senseless_parameters(scene: Scene, wrong: dict[str, float]) -> None:
    """A parameter out of its range is refused."""
    with pytest.raises(InputError, match=f"cluster-cut: expected .*{next(iter(wrong))}.*, got"):
        ClusterCut(**wrong).reset(scene, 10.0)
