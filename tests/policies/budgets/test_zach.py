"""Zach's mixed selection on small scenes worked by hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.tree import Tree
from lodbench.policies.budgets.zach import Zach
from lodbench.policies.registry import parse_policy
from lodbench.policies.selection import Selection, find_violation
from lodbench.policies.view import View

Make = Callable[..., Any]
PAPER = CostModel.of(0.0, {"draw_calls": 2.45e-3, "splats": 0.35e-3, "vertices": 0.06e-3})
SPLATS = LEVEL_PREDICTORS.index("splats")
TREES = LEVEL_PREDICTORS.index("draw_calls")
TRIANGLES = LEVEL_PREDICTORS.index("triangles")
PATCH = LevelTable(
    np.array([0, 1]),
    50.0 * (np.arange(len(LEVEL_PREDICTORS)) == TRIANGLES)[None, :],
    np.zeros(1),
    np.zeros(1),
    np.array([False]),
)


def choose(scene: Scene, view: View, budget_ms: float, **params: Any) -> Selection:
    """Return a valid selection of a new policy."""
    policy = Zach(**params)
    policy.reset(scene, budget_ms)
    selection = policy.select(view)
    tree = None if scene.flat else Tree(scene)
    assert find_violation(selection, view.ids, scene, tree) is None
    return selection


def groups(trees: float, splats: float) -> LevelTable:
    """Return a type of so many trees of so many splats each, at least one."""
    counts = np.zeros((2, len(LEVEL_PREDICTORS)))
    counts[:, TREES] = trees
    counts[:, SPLATS] = trees * splats, trees
    none = np.zeros(2)
    return LevelTable(np.array([0, 2]), counts, none, none, np.array([True]))


def true_ms(view: View, selection: Selection, costs: CostModel) -> float:
    """Return what a selection costs, from the counts of its levels (linear, whatever the view)."""
    levels, seen = view.scene.types.levels, view.at(selection.ids)
    row, fraction = levels.position(seen.type_index, selection.detail)
    counts = levels.interpolate(levels.counts, row, fraction).sum(axis=0)
    return costs.base_ms + float(counts @ costs.linear_ms[: len(counts)])


@pytest.fixture
def see(make_tree_view: Make, make_view: Make) -> Callable[..., View]:
    """Return a function that shows a scene: the roots in view, or all nodes of a flat one."""

    def show(scene: Scene, *camera: Camera) -> View:
        return (make_view if scene.flat else make_tree_view)(scene, *camera)

    return show


@pytest.mark.parametrize(("left_ms", "resolution"), [(0.19, None), (0.21, 0.11), (2.0, 1.0)])
def test_a_group_is_drawn_if_its_splats_are_worth_its_setup(
    left_ms: float, resolution: float | None, make_scene: Make, see: Make
) -> None:
    """Ten trees cost 0.1 ms to set up; with 0.19 ms, less than that would be left for splats."""
    costs = CostModel.of(1.0, {"draw_calls": 0.01, "splats": 1e-3})
    scene = make_scene([(0.0, 0.0, -5.0)], levels=groups(10.0, 100.0)).with_costs(costs)
    selection = choose(scene, see(scene), 1.0 + left_ms)
    assert selection.detail.tolist() == pytest.approx([] if resolution is None else [resolution])


@pytest.mark.parametrize(("left_ms", "drawn"), [(0.009, 0), (0.011, 1), (0.019, 1), (0.021, 2)])
def test_a_tree_with_less_than_a_splat_is_not_drawn(
    left_ms: float, drawn: int, make_scene: Make, see: Make
) -> None:
    """Two groups of ten trees whose setup is free: each needs ten splats of 1 µs."""
    costs = CostModel.of(1.0, {"splats": 1e-3})
    positions = [(0.0, 0.0, -5.0), (0.0, 0.0, -5.0)]
    scene = make_scene(positions, levels=groups(10.0, 100.0)).with_costs(costs)
    selection = choose(scene, see(scene), 1.0 + left_ms)
    assert len(selection.ids) == drawn
    assert (selection.detail >= 0.01).all()


def test_small_groups_are_culled_and_small_objects_are_not(
    make_scene: Make, make_levels: Make, see: Make
) -> None:
    """Of spheres 1.0 px wide at 100 m a group of splats is left out with any budget, a mesh not."""
    far = [(0.0, 0.0, -100.0)]
    mesh = make_levels(((100.0, 10.0),), continuous=True)
    for levels, drawn in ((groups(10.0, 100.0), 0), (mesh, 1)):
        scene = make_scene(far, levels=levels).with_costs(PAPER)
        assert len(choose(scene, see(scene), 1e3).ids) == drawn
        assert len(choose(scene, see(scene), 1e3, cull_px=0.5).ids) == 1


def test_the_patch_with_more_pixels_is_refined_first(make_scene: Make, see: Make) -> None:
    """Two patches of 50 triangles over two of 50 each, a gain of 0.41 S for 50 µs each."""
    x, near, far = [-0.5, 0.5], -10.0, -20.0
    scene = make_scene(
        [(0.0, 0.0, far), (0.0, 0.0, near), *((i, 0.0, z) for z in (far, near) for i in x)],
        parent=[-1, -1, 0, 0, 1, 1],
        levels=PATCH,
    ).with_costs(CostModel.of(1.0, {"triangles": 1e-3}))
    view = see(scene)
    for budget_ms, front in ((1.14, [0, 1]), (1.16, [0, 4, 5]), (1.21, [2, 3, 4, 5])):
        assert sorted(choose(scene, view, budget_ms).ids) == front


def test_levels_are_refined_by_benefit_per_cost(
    make_scene: Make, make_levels: Make, see: Make
) -> None:
    """Benefits S, 1.41 S, 2 S at 50, 250 and 1000 triangles: slopes 2.07 and 0.78 S per 1000.

    The second object has half the area: 1.04 and 0.39.  So the order is near, far, near, far.
    """
    costs = CostModel.of(1.0, {"triangles": 1e-3})
    depth = 5.0 * np.sqrt(2.0)
    scene = make_scene([(0.0, 0.0, -5.0), (0.0, 0.0, -depth)], radius_m=0.1).with_costs(costs)
    view = see(scene)
    for budget_ms, detail in ((1.25, [2, 2]), (1.35, [1, 2]), (1.55, [1, 1]), (2.3, [0, 1])):
        selection = choose(scene, view, budget_ms)
        assert selection.detail.tolist() == detail
        assert selection.predicted_ms == pytest.approx(true_ms(view, selection, costs))


def test_importance_outweighs_size(make_scene: Make, see: Make) -> None:
    """The farther object, ten times as important, is refined first."""
    costs = CostModel.of(1.0, {"triangles": 1e-3})
    positions = [(0.0, 0.0, -5.0), (0.0, 0.0, -7.0)]
    scene = make_scene(positions, importance=[1.0, 10.0]).with_costs(costs)
    assert choose(scene, see(scene), 1.35).detail.tolist() == [2.0, 1.0]


def test_smooth_and_discrete_objects_share_one_budget(
    make_scene: Make, make_levels: Make, see: Make
) -> None:
    """A level is taken while it gains more per cost than the smooth object, which has the rest."""
    levels = make_levels(((1000.0, 100.0), (1000.0, 100.0)), continuous=[False, True])
    costs = CostModel.of(1.0, {"triangles": 1e-3})
    positions = [(0.0, 0.0, -5.0), (0.0, 0.0, -5.0)]
    scene = make_scene(positions, kind=[0, 1], levels=levels).with_costs(costs)
    view = see(scene)
    for budget_ms, level, resolution in ((1.9, 1.0, 0.8), (2.2, 0.0, 0.2), (3.0, 0.0, 1.0)):
        selection = choose(scene, view, budget_ms)
        assert selection.ids.tolist() == [0, 1]
        assert selection.detail == pytest.approx([level, resolution], abs=1e-6)


def test_what_is_no_group_is_drawn_even_over_budget(
    make_scene: Make, make_levels: Make, see: Make
) -> None:
    """Discrete and smooth meshes at their coarsest, groups of splats not at all."""
    triangles, splats = make_levels(((1000.0, 100.0),) * 2, continuous=[False, True]), groups(9, 9)
    levels = LevelTable(
        np.array([0, 2, 4, 6]),
        np.concatenate((triangles.counts, splats.counts)),
        np.concatenate((triangles.error_m, splats.error_m)),
        np.concatenate((triangles.bytes, splats.bytes)),
        np.array([False, True, True]),
    )
    positions = [(0.0, 0.0, -5.0)] * 3
    scene = make_scene(positions, kind=[0, 1, 2], levels=levels)
    costs = CostModel.of(1.0, {"triangles": 1e-3, "splats": 1e-3})
    view = see(scene.with_costs(costs))
    selection = choose(scene.with_costs(costs), view, 1.1)
    assert selection.ids.tolist() == [0, 1]
    assert selection.detail == pytest.approx([1.0, 0.1])
    assert selection.predicted_ms == pytest.approx(1.2)


def test_continuous_nodes_above_others_are_refined_in_knots(
    make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """A continuous root goes from its coarser knot to its finer one, then to its children."""
    levels = make_levels(((400.0, 100.0), (1000.0, 250.0)), continuous=[True, True])
    costs = CostModel.of(0.0, {"triangles": 1e-3})
    scene = make_scene(
        [(0.0, 0.0, -10.0), (-0.5, 0.0, -10.0), (0.5, 0.0, -10.0)],
        kind=[0, 1, 1],
        parent=[-1, 0, 0],
        levels=levels,
    ).with_costs(costs)
    view = make_tree_view(scene)
    expected = ((0.2, [0], [0.25]), (0.45, [0], [1.0]), (0.55, [1, 2], [0.25, 0.25]))
    for budget_ms, ids, detail in (*expected, (5.0, [1, 2], [1.0, 1.0])):
        selection = choose(scene, view, budget_ms)
        assert selection.ids.tolist() == ids
        assert selection.detail == pytest.approx(detail)


def test_nodes_that_stay_drawn_are_joined_by_their_children(
    make_scene: Make, make_tree_view: Make
) -> None:
    """A child of an additive root is drawn beside it when there is time for both."""
    positions = [(0.0, 0.0, -10.0), (0.5, 0.0, -10.0)]
    scene = make_scene(
        positions,
        parent=[-1, 0],
        additive=[True, False],
    ).with_costs(CostModel.of(0.0, {"triangles": 1e-3}))
    view = make_tree_view(scene)
    assert choose(scene, view, 0.09).ids.tolist() == [0]
    assert choose(scene, view, 1.06).ids.tolist() == [0, 1]


def test_children_of_a_culled_node_stand_below_what_is_above_it(
    make_scene: Make, make_tree_view: Make
) -> None:
    """Root in view, its child beside the view, the grandchild in view again: drawn for the root."""
    scene = make_scene(
        [(0.0, 0.0, -10.0), (50.0, 0.0, -10.0), (0.5, 0.0, -10.0)], parent=[-1, 0, 1]
    ).with_costs(CostModel.of(0.0, {"triangles": 1e-3}))
    view = make_tree_view(scene)
    assert choose(scene, view, 0.1).ids.tolist() == [0]
    assert choose(scene, view, 9.0).ids.tolist() == [2]


def test_nothing_in_view_costs_the_frame(make_scene: Make, see: Make) -> None:
    """An empty frame is predicted at what every frame costs."""
    scene = make_scene([(0.0, 0.0, 5.0)]).with_costs(CostModel.of(1.5, {}))
    selection = choose(scene, see(scene), 5.0)
    assert len(selection.ids) == 0
    assert selection.predicted_ms == 1.5


def test_hierarchies_without_groups_are_driven_too(
    city: Scene, make_tree_view: Make, make_hardware: Make
) -> None:
    """On facades of unequal trees every budget is kept, and more of it brings more triangles."""
    costs = make_hardware({"draw_calls": 1e-3, "triangles": 1e-5}, base_ms=0.5).gpu
    scene = city.with_costs(costs)
    camera = Camera((220.0, 220.0, 900.0), (0.0, 0.0, 0.0, 1.0), 1280, 720, 1.0)
    view = make_tree_view(scene, camera)
    primitives, last = Tree(scene).primitives, 0.0
    for budget_ms in (0.1, 3.0, 6.0, 12.0, 1000.0):
        selection = choose(scene, view, budget_ms)
        assert selection.predicted_ms == pytest.approx(true_ms(view, selection, costs))
        drawn = float(primitives[selection.ids].sum())
        assert drawn > last or budget_ms == 0.1
        if budget_ms > 2.0:
            assert selection.predicted_ms <= budget_ms
        last = drawn
    leaves = np.flatnonzero(Tree(scene).leaf & view.state.inside)
    assert sorted(selection.ids) == leaves.tolist()


@pytest.mark.parametrize("wrong", ["epsilon", "barrier", "cull_px", "max_steps"])
def test_negative_parameters_are_refused(wrong: str, make_scene: Make) -> None:
    """Each parameter below zero is an error before the first frame."""
    scene = make_scene([(0.0, 0.0, -5.0)]).with_costs(PAPER)
    with pytest.raises(InputError, match=f"zach: expected {wrong} in .*, got -1"):
        parse_policy(f"zach:{wrong}=-1").make().reset(scene, 5.0)


def test_a_scene_without_costs_is_refused(make_scene: Make) -> None:
    """A predictive policy says that it needs a cost model."""
    with pytest.raises(InputError, match="zach: expected a scene with a cost model"):
        Zach().reset(make_scene([(0.0, 0.0, -5.0)]), 5.0)


def test_it_is_registered_by_the_issues_words() -> None:
    """Splitting is switched on and off by name."""
    policy = parse_policy("zach:splitting=off,engine=gradient").make()
    assert policy == Zach(splitting=False, engine="gradient")
