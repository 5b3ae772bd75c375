"""Maciel and Shirley's policy: the fixed threshold, and what is not held back by it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.policies.hierarchies.maciel import Maciel

Make = Callable[..., Any]


@pytest.fixture
def pair(make_scene: Make, make_levels: Make) -> Scene:
    """Return roots 0 and 3 of 100 triangles, 10 and 30 m ahead, each above two of 300."""
    position = [(x, 0.0, -10.0) for x in (-1.0, -1.5, -0.5)]
    position += [(x, 0.0, -30.0) for x in (1.0, 0.5, 1.5)]
    levels = make_levels([[100.0], [300.0], [300.0]] * 2)
    scene = make_scene(position, kind=np.arange(6), parent=[-1, 0, 0, -1, 3, 3], levels=levels)
    return scene.with_costs(CostModel.of(1.0, {"triangles": 1e-3}))


@pytest.fixture
def sides(pair: Scene, make_tree_view: Make) -> list[Any]:
    """Return views that see both: from the front, nearer to root 0, and the back, nearer to 3."""
    turned = (0.0, 1.0, 0.0, 0.0)  # looks along z
    front = Camera((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 100, 100, np.pi / 2)
    back = Camera((0.0, 0.0, -40.0), turned, 100, 100, np.pi / 2)
    return [make_tree_view(pair, camera) for camera in (front, back)]


def _drawn(policy: Maciel, view: Any) -> list[int]:
    return policy.select(view).ids.tolist()


def test_refines_after_more_than_threshold_wishes(pair: Scene, make_tree_view: Make) -> None:
    """With a threshold of 3 the first three frames draw the roots and the fourth the children."""
    policy = Maciel(threshold=3)
    policy.reset(pair, 10.0)
    view = make_tree_view(pair)
    frames = [_drawn(policy, view) for _ in range(5)]
    assert frames == [[0, 3]] * 3 + [[1, 2, 4, 5]] * 2


def test_a_wish_that_ends_is_forgotten(pair: Scene, sides: list[Any]) -> None:
    """Wishes have to follow on each other: one frame without starts the count anew."""
    policy = Maciel(threshold=2)
    policy.reset(pair, 1.0 + 0.2 + 0.5)  # enough for one refinement
    front, back = sides
    frames = [_drawn(policy, view) for view in (front, front, back, front, front, front)]
    assert frames[:5] == [[0, 3]] * 5
    assert frames[5] == [1, 2, 3]


def test_coarsens_at_once(pair: Scene, sides: list[Any]) -> None:
    """When the other root is worth more, the refined one gives way in the same frame."""
    policy = Maciel(threshold=1)
    policy.reset(pair, 1.0 + 0.2 + 0.5)
    front, back = sides
    frames = [_drawn(policy, view) for view in (front, front, back, back)]
    assert frames == [[0, 3], [1, 2, 3], [0, 3], [0, 4, 5]]


def test_prediction_keeps_the_budget(pair: Scene, make_tree_view: Make) -> None:
    """Whatever the budget from the roots' cost up, the predicted time is within it."""
    for budget_ms in (1.2, 1.69, 1.7, 2.19, 2.2, 5.0):
        policy = Maciel(threshold=0)
        policy.reset(pair, budget_ms)
        selection = policy.select(make_tree_view(pair))
        assert selection.predicted_ms <= budget_ms + 1e-12
        triangles = np.array([100.0, 300.0, 300.0] * 2)[selection.ids].sum()
        assert selection.predicted_ms == pytest.approx(1.0 + 1e-3 * triangles)


def test_threshold_must_not_be_negative(pair: Scene) -> None:
    """A negative count of frames is refused."""
    with pytest.raises(InputError, match=r"threshold in \[0, inf\], got -1"):
        Maciel(threshold=-1).reset(pair, 10.0)
