"""Erikson's policy: polygons that past frames could afford go to the largest errors."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.scene import Scene
from lodbench.policies.hierarchies.erikson import Erikson

Make = Callable[..., Any]
BUDGET_MS = 10.0


@pytest.fixture
def pair(make_scene: Make, make_levels: Make) -> Scene:
    """Return roots 0 and 3 of 100 triangles, errors 0.1 and 0.2 m, each above two of 150."""
    position = [(x, 0.0, -10.0) for x in (-4.0, -4.5, -3.5, 4.0, 3.5, 4.5)]
    levels = make_levels(
        [[100.0], [150.0], [150.0]] * 2, error_m=[[0.1], [0.0], [0.0], [0.2], [0.0], [0.0]]
    )
    return make_scene(position, kind=np.arange(6), parent=[-1, 0, 0, -1, 3, 3], levels=levels)


def _drawn(policy: Erikson, scene: Scene, view: Make, work_ms: Sequence[float]) -> list[int]:
    return policy.select(view(scene, work_ms=work_ms)).ids.tolist()


@pytest.mark.parametrize(
    ("time_ms", "expected"),
    [
        (9.0, [0, 3]),  # 200 triangles in 9 ms: 200 fit the target of 9 ms
        (4.51, [0, 3]),  # 399.1 fit, 400 are needed to refine one
        (4.49, [0, 4, 5]),  # 400.9 fit: the larger error first
        (3.01, [0, 4, 5]),  # 598.0
        (2.99, [1, 2, 4, 5]),  # 602.0 fit, 600 are needed for both
    ],
)
def test_budget_is_polygons_of_a_frame_times_target_over_its_time(
    pair: Scene, make_tree_view: Make, time_ms: float, expected: list[int]
) -> None:
    """200 triangles drawn in t ms allow 200 · 0.9 · 10 / t."""
    policy = Erikson()
    policy.reset(pair, BUDGET_MS)
    assert _drawn(policy, pair, make_tree_view, []) == [0, 3]
    assert _drawn(policy, pair, make_tree_view, [time_ms]) == expected


@pytest.mark.parametrize("fault", [float("nan"), 0.0, -1.0, 8.0])
def test_faulty_times_do_not_raise_detail(pair: Scene, make_tree_view: Make, fault: float) -> None:
    """A report that is missing, zero, negative or the last one again changes nothing."""
    policy = Erikson()
    policy.reset(pair, BUDGET_MS)
    _drawn(policy, pair, make_tree_view, [])
    assert _drawn(policy, pair, make_tree_view, [8.0]) == [0, 3]
    assert _drawn(policy, pair, make_tree_view, [8.0, fault]) == [0, 3]


def test_what_has_no_error_is_not_refined(
    make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """Polygons to spare do not refine a root that is exact already."""
    scene = make_scene(
        [(0.0, 0.0, -10.0)] * 2,
        kind=[0, 1],
        parent=[-1, 0],
        levels=make_levels([[100.0], [150.0]], error_m=[[0.0], [0.0]]),
    )
    policy = Erikson()
    policy.reset(scene, BUDGET_MS)
    _drawn(policy, scene, make_tree_view, [])
    assert _drawn(policy, scene, make_tree_view, [0.1]) == [0]


def test_target_is_a_share(pair: Scene) -> None:
    """A target above the whole budget is refused."""
    with pytest.raises(InputError, match=r"target in \(0, 1\], got 1.5"):
        Erikson(target=1.5).reset(pair, BUDGET_MS)
