"""Fronts from refined nodes, waiting for memory, and what drawing and refining nodes adds."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.frame_cost import FrameCost
from lodbench.models.scene.scene import Scene
from lodbench.policies.shared.trees.hierarchy import Gains, Hierarchy, NodeCosts, gains

Make = Callable[..., Any]
COSTS = CostModel.of(1.0, {"triangles": 1e-3, "state_changes": 0.25, "framebuffer_pixels": 1e-5})


@pytest.fixture
def three_levels(make_scene: Make, make_levels: Make) -> Callable[..., Scene]:
    """Return a function that builds 0 -> (1, 2), 1 -> (3, 4); node 4 stands behind the camera."""

    def build(triangles: tuple[float, ...] = (10.0, 20.0, 30.0, 40.0, 50.0), **more: Any) -> Scene:
        levels = make_levels([[t] for t in triangles])
        positions = [(0.0, 0.0, -10.0)] * 4 + [(0.0, 0.0, 90.0)]
        return make_scene(
            positions, kind=np.arange(5), parent=[-1, 0, 0, 1, 1], levels=levels, **more
        )

    return build


def _mask(*nodes: int) -> np.ndarray:
    mask = np.zeros(5, dtype=bool)
    mask[list(nodes)] = True
    return mask


def test_refined_nodes_give_way_to_their_children_in_view(
    three_levels: Make, make_tree_view: Make
) -> None:
    """Refining nodes 0 and 1 draws 2 and 3; node 4, behind the camera, is not drawn."""
    scene = three_levels()
    tree, view = Hierarchy(scene), make_tree_view(scene)
    assert tree.front(view, _mask())[0].tolist() == [0]
    assert tree.front(view, _mask(0))[0].tolist() == [1, 2]
    assert tree.front(view, _mask(0, 1))[0].tolist() == [2, 3]


def test_nodes_that_add_stay_drawn(three_levels: Make, make_tree_view: Make) -> None:
    """A refined additive node is drawn beside its children."""
    scene = three_levels(additive=[True, False, False, False, False])
    tree, view = Hierarchy(scene), make_tree_view(scene)
    assert tree.front(view, _mask(0, 1))[0].tolist() == [0, 2, 3]


def test_a_wish_needs_its_ancestors(three_levels: Make, make_tree_view: Make) -> None:
    """Node 1 is not refined unless node 0 is; leaves never are."""
    scene = three_levels()
    tree, view = Hierarchy(scene), make_tree_view(scene)
    assert np.flatnonzero(tree.close(view, _mask(1, 2))).tolist() == []
    assert np.flatnonzero(tree.close(view, _mask(0, 1, 2))).tolist() == [0, 1]


def test_empty_nodes_are_refined_where_they_are_reached(
    three_levels: Make, make_tree_view: Make
) -> None:
    """A node without geometry gives way by itself, and its parent carries what that costs."""
    scene = three_levels(triangles=(10.0, 0.0, 30.0, 40.0, 50.0))
    tree, view = Hierarchy(scene), make_tree_view(scene)
    assert np.flatnonzero(tree.close(view, _mask())).tolist() == []
    assert np.flatnonzero(tree.close(view, _mask(0))).tolist() == [0, 1]
    assert tree.fold_empty(np.array([20.0, 40.0, 0.0, 0.0, 0.0])).tolist() == [60.0, 0, 0, 0, 0]


def test_nodes_wait_for_children_in_view(three_levels: Make, make_tree_view: Make) -> None:
    """Node 1 waits for node 4, which is out of view, only if it is to wait for all."""
    scene = three_levels()
    tree = Hierarchy(scene)
    view = make_tree_view(scene, residency=~_mask(4))
    assert np.flatnonzero(tree.waits(view)).tolist() == []
    assert np.flatnonzero(tree.waits(view, for_all=True)).tolist() == [1]
    view = make_tree_view(scene, residency=~_mask(2))
    assert np.flatnonzero(tree.waits(view)).tolist() == [0]


def test_empty_children_are_as_good_as_what_is_below_them(
    three_levels: Make, make_tree_view: Make
) -> None:
    """Node 0 waits for node 3 below the empty node 1, which has no data of its own."""
    scene = three_levels(triangles=(10.0, 0.0, 30.0, 40.0, 50.0))
    view = make_tree_view(scene, residency=~_mask(3))
    assert np.flatnonzero(Hierarchy(scene).waits(view)).tolist() == [0, 1]


def node_costs(scene: Scene, model: CostModel) -> NodeCosts:
    """Return what the nodes of a scene cost by a model."""
    return NodeCosts(scene, FrameCost(model, scene.types.levels))


def test_costs_of_nodes_and_of_the_frame(three_levels: Make, make_tree_view: Make) -> None:
    """A node costs its triangles and, alone of its type, a change of state; the rest is fixed."""
    scene = three_levels()
    view = make_tree_view(scene)
    costs = node_costs(scene, COSTS)
    assert costs.node_ms(view.at(np.array([0, 2]))) == pytest.approx([0.26, 0.28])
    assert costs.fixed_ms(view) == pytest.approx(1.0 + 0.1)


def test_shared_types_change_state_once_a_frame(
    make_scene: Make, make_levels: Make, make_tree_view: Make
) -> None:
    """Two nodes of one type are charged one change between them, whatever is drawn."""
    scene = make_scene(
        [(0.0, 0.0, -10.0)] * 3, kind=[0, 1, 1], parent=[-1, 0, 0], levels=make_levels([[8], [9]])
    )
    costs, view = node_costs(scene, COSTS), make_tree_view(scene)
    assert costs.node_ms(view.at(np.array([0, 1]))) == pytest.approx([0.258, 0.009])
    assert costs.fixed_ms(view) == pytest.approx(1.0 + 0.1 + 0.25)


def _gains(scene: Scene, view: Any) -> Gains:
    return gains(Hierarchy(scene), node_costs(scene, CostModel.of(0.0, {"triangles": 1.0})), view)


def test_benefit_is_that_of_the_leaves_in_view(three_levels: Make, make_tree_view: Make) -> None:
    """A leaf has the samples of the node drawn for it by its share of the leaves' primitives."""
    scene = three_levels()
    view = make_tree_view(scene)
    found = _gains(scene, view)
    area = view.at(np.array([3])).area_px[0]
    # Leaves 2, 3 and 4 have 30, 40 and 50 of 120 triangles; 4 is out of view.
    node_0 = area * (1 - 0.5 / (10 * 30 / 120)) + area * (1 - 0.5 / (10 * 40 / 120))
    node_1 = area * (1 - 0.5 / (20 * 40 / 90))
    leaf_2, leaf_3 = area * (1 - 0.5 / 30), area * (1 - 0.5 / 40)
    assert found.benefit[[0, 1, 2, 3, 4]] == pytest.approx([node_0, node_1, leaf_2, leaf_3, 0.0])
    assert found.more_benefit[:2] == pytest.approx([node_1 + leaf_2 - node_0, leaf_3 - node_1])
    assert found.more_ms[:2] == pytest.approx([20 + 30 - 10, 40 - 20])
    assert found.visited == 4


def test_additive_nodes_cost_and_stand_for_themselves(
    three_levels: Make, make_tree_view: Make
) -> None:
    """Refining a node that stays drawn adds its children whole."""
    scene = three_levels(additive=[True, False, False, False, False])
    view = make_tree_view(scene)
    found = _gains(scene, view)
    area = view.at(np.array([0])).area_px[0]
    assert found.benefit[0] == pytest.approx(area * (1 - 0.5 / 10))
    assert found.more_ms[0] == pytest.approx(20 + 30)
    assert found.more_benefit[0] == pytest.approx(found.benefit[1] + found.benefit[2])
