"""Funkhouser and Séquin's policy: the budget, the factors of benefit, and levels by hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.funkhouser import Funkhouser
from lodbench.policies.controllers.predictive import Predictive
from lodbench.policies.view import View

Make = Callable[..., Any]
COSTS = CostModel.of(1.0, {"triangles": 1e-3})
MODES = ("greedy", "incremental", "hull")


@pytest.fixture
def row_of_objects(make_scene: Make, make_levels: Make) -> Callable[..., Scene]:
    """Return a function that sets objects of 1000, 250 and 50 triangles ahead of the camera."""

    def build(depths_m: list[float], **more: Any) -> Scene:
        positions = [(0.0, 0.0, -depth) for depth in depths_m]
        levels = make_levels(((1000.0, 250.0, 50.0),))
        return make_scene(positions, levels=levels, **more).with_costs(COSTS)

    return build


def triangles_of(view: View, detail: Any) -> float:
    """Return the triangles of levels of the one type."""
    return float(np.array([1000.0, 250.0, 50.0])[np.asarray(detail, dtype=int)].sum())


@pytest.mark.parametrize("mode", MODES)
def test_prediction_is_the_cost_of_the_selection_and_within_budget(
    mode: Any, row_of_objects: Make, make_view: Make
) -> None:
    """The predicted time is 1 ms and 1 µs a triangle, never over a budget that can be met."""
    scene = row_of_objects([5.0, 10.0, 20.0, 40.0])
    view = make_view(scene)
    for budget_ms in (1.2, 1.5, 2.0, 3.0, 5.0):
        policy = Funkhouser(mode=mode)
        policy.reset(scene, budget_ms)
        selection = policy.select(view)
        spent_ms = 1.0 + 1e-3 * triangles_of(view, selection.detail)
        assert selection.predicted_ms == pytest.approx(spent_ms)
        assert selection.predicted_ms <= budget_ms + 1e-12


@pytest.mark.parametrize("mode", MODES)
def test_budget_below_the_coarsest_levels_draws_them(
    mode: Any, row_of_objects: Make, make_view: Make
) -> None:
    """With no time left every object is at its coarsest level, none is left out."""
    scene = row_of_objects([5.0, 10.0])
    policy = Funkhouser(mode=mode)
    policy.reset(scene, 0.1)
    assert policy.select(make_view(scene)).detail.tolist() == [2.0, 2.0]


@pytest.mark.parametrize("mode", MODES)
def test_plenty_of_budget_draws_everything_in_full(
    mode: Any, row_of_objects: Make, make_view: Make
) -> None:
    """With time for all, every object is at its finest level."""
    scene = row_of_objects([5.0, 10.0, 80.0])
    policy = Funkhouser(mode=mode, hysteresis=0.0)
    policy.reset(scene, 100.0)
    assert policy.select(make_view(scene)).detail.tolist() == [0.0, 0.0, 0.0]


def test_the_larger_object_is_refined_first(row_of_objects: Make, make_view: Make) -> None:
    """With time for one object in full, it goes to the one with more pixels."""
    scene = row_of_objects([40.0, 5.0])
    policy = Funkhouser(hysteresis=0.0, focus=0.0, motion=0.0)
    policy.reset(scene, 1.0 + 1.06)
    assert policy.select(make_view(scene)).detail.tolist() == [2.0, 0.0]


def test_importance_outweighs_size(row_of_objects: Make, make_view: Make) -> None:
    """An object a thousand times as important is refined before a larger one."""
    scene = row_of_objects([40.0, 5.0], importance=[1000.0, 1.0])
    policy = Funkhouser(hysteresis=0.0, focus=0.0, motion=0.0)
    policy.reset(scene, 1.0 + 1.06)
    assert policy.select(make_view(scene)).detail.tolist() == [0.0, 2.0]


def test_focus_prefers_the_centre(make_scene: Make, make_levels: Make, make_view: Make) -> None:
    """Of two objects of one size the one at the screen's centre is refined first."""
    # Off the axis perspective stretches an image, so the one at the side even has more pixels.
    positions = [(8.0, 0.0, -10.0), (0.0, 0.0, -(164.0**0.5))]
    scene = make_scene(positions, levels=make_levels(((1000.0, 50.0),))).with_costs(COSTS)
    policy = Funkhouser(hysteresis=0.0, motion=0.0, focus=0.99)
    policy.reset(scene, 1.0 + 1.06)
    assert policy.select(make_view(scene)).detail.tolist() == [1.0, 0.0]


def test_skip_leaves_out_what_the_budget_cannot_hold(row_of_objects: Make, make_view: Make) -> None:
    """With skip the budget holds even below the coarsest levels, at the price of holes."""
    scene = row_of_objects([5.0, 40.0])
    for mode in MODES:
        policy = Funkhouser(mode=mode, skip=True, hysteresis=0.0)
        policy.reset(scene, 1.06)
        selection = policy.select(make_view(scene))
        assert selection.ids.tolist() == [0]
        assert selection.detail.tolist() == [2.0]
        assert selection.predicted_ms <= 1.06


def test_hysteresis_keeps_the_last_level_when_the_gain_is_small(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """A strong hysteresis holds levels that a memoryless policy would swap."""

    def two(near_m: float, far_m: float) -> Scene:
        levels = make_levels(((1000.0, 50.0),))
        return make_scene([(0, 0, -near_m), (0, 0, -far_m)], levels=levels).with_costs(COSTS)

    scene, swapped = two(10.0, 10.1), two(10.1, 10.0)
    held, free = (Funkhouser(hysteresis=h, focus=0.0, motion=0.0) for h in (1e-3, 0.0))
    results: dict[str, list[float]] = {}
    for name, policy in (("held", held), ("free", free)):
        policy.reset(scene, 1.0 + 1.06)
        first = policy.select(make_view(scene)).detail.tolist()
        assert first == [0.0, 1.0]
        results[name] = policy.select(make_view(swapped)).detail.tolist()
    assert results == {"held": [0.0, 1.0], "free": [1.0, 0.0]}


def test_continuous_types_take_resolutions_of_their_knots(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """The stated discretisation of a continuous type is its level table."""
    levels = make_levels(((1000.0, 250.0, 50.0),), continuous=True)
    scene = make_scene([(0.0, 0.0, -5.0), (0.0, 0.0, -40.0)], levels=levels).with_costs(COSTS)
    policy = Funkhouser(hysteresis=0.0)
    policy.reset(scene, 1.0 + 1.06)
    assert policy.select(make_view(scene)).detail.tolist() == [1.0, 0.05]


def test_trees_choose_fronts_of_uniform_depth(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """A root with two children is drawn itself under a small budget, by them under a large one."""
    levels = make_levels(((100.0,), (400.0,)))
    scene = make_scene(
        [(0.0, 0.0, -10.0), (-0.5, 0.0, -10.0), (0.5, 0.0, -10.0)],
        kind=[0, 1, 1],
        parent=[-1, 0, 0],
        levels=levels,
        radius_m=[2.0, 1.0],
    ).with_costs(COSTS)
    for budget_ms, front in ((1.2, [0]), (1.9, [1, 2])):
        policy = Funkhouser(hysteresis=0.0)
        policy.reset(scene, budget_ms)
        view = make_view(scene)
        selection = policy.select(view.at(scene.roots))
        assert selection.ids.tolist() == front


@pytest.mark.parametrize("name", [*MODES, "predictive"])
@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_loose_spheres_are_refined_where_time_is_plenty(
    name: Any, exponent: float, make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """Children whose spheres cover a tenth of their parent's: the leaves are drawn all the same."""
    levels = make_levels(((100.0,), (150.0,), (400.0,)))
    position_m = [(0.0, 0.0, -40.0)] + [(x, 0.0, -40.0) for x in (-8, 8, -9, -7, 7, 9)]
    scene = make_scene(
        position_m,
        kind=[0, 1, 1, 2, 2, 2, 2],
        parent=[-1, 0, 0, 1, 1, 2, 2],
        levels=levels,
        radius_m=[12.0, 3.0, 0.7],
    ).with_costs(COSTS)
    inner = Funkhouser(mode="hull" if name == "predictive" else name, exponent=exponent)
    policy = Predictive("funkhouser+exponent=2") if name == "predictive" else inner
    for budget_ms, front in ((1e6, [3, 4, 5, 6]), (1e-3, [0])):
        policy.reset(scene, budget_ms)
        assert policy.select(make_tree_view(scene)).ids.tolist() == front


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize(("budget_ms", "resolution"), [(1.1, 0.2), (1.3, 1.0)])
def test_groups_below_a_node_without_geometry_give_way_by_their_knots(
    mode: Any,
    budget_ms: float,
    resolution: float,
    make_scene: Make,
    make_levels: Make,
    make_view: Make,
) -> None:
    """Two groups of 100 or 20 triangles: 1.2 or 1.04 ms; the empty node above is never drawn."""
    scene = make_scene(
        [(0.0, 0.0, -10.0), (-0.5, 0.0, -10.0), (0.5, 0.0, -10.0)],
        kind=[0, 1, 1],
        parent=[-1, 0, 0],
        levels=make_levels(((0.0,), (100.0, 20.0)), continuous=[False, True]),
        radius_m=[2.0, 1.0],
    ).with_costs(COSTS)
    policy = Funkhouser(mode=mode)
    policy.reset(scene, budget_ms)
    selection = policy.select(make_view(scene).at(scene.roots))
    assert selection.ids.tolist() == [1, 2]
    assert selection.detail.tolist() == [resolution, resolution]
    assert selection.predicted_ms <= budget_ms


def test_nothing_in_view_is_no_error(row_of_objects: Make, make_view: Make) -> None:
    """An empty frame gives an empty selection that costs the base."""
    scene = row_of_objects([-5.0])
    policy = Funkhouser()
    policy.reset(scene, 5.0)
    selection = policy.select(make_view(scene))
    assert len(selection.ids) == 0
    assert selection.predicted_ms == 1.0


@pytest.mark.parametrize(
    "wrong",
    [
        {"mode": "best"},
        {"misfit": "both"},
        {"exponent": 0.0},
        {"focus": 1.0},
        {"motion": -1.0},
        {"hysteresis": -0.1},
        {"max_steps": -1},
    ],
)
def test_parameters_that_make_no_sense_are_refused(
    wrong: dict[str, Any], row_of_objects: Make
) -> None:
    """Each parameter outside its range is an error before the first frame."""
    with pytest.raises(InputError, match=f"funkhouser: expected .*{next(iter(wrong))}.*, got"):
        Funkhouser(**wrong).reset(row_of_objects([5.0]), 5.0)


def test_scene_without_costs_is_refused(make_scene: Make) -> None:
    """A predictive policy says that it needs a cost model."""
    with pytest.raises(InputError, match="expected a scene with a cost model"):
        Funkhouser().reset(make_scene([(0.0, 0.0, -5.0)]), 5.0)
