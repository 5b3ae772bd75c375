"""Scenes: derived arrays, the tree of nodes, and one error for each rule."""

import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.content import require_content
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.motion import Motion
from lodbench.models.scene.scene import ObjectTypes, Scene

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]


def test_bounding_spheres_by_hand(make_scene: MakeScene) -> None:
    """A centre 1 m along x, scaled by 2 and turned a quarter about z, lies 2 m along y."""
    quarter = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))
    scene = make_scene(
        [(10.0, 0.0, 5.0)],
        center_m=(1.0, 0.0, 0.0), radius_m=3.0, scale=2.0, orientation_xyzw=quarter,
    )  # fmt: skip
    assert scene.center_m == pytest.approx(np.array([[10.0, 2.0, 5.0]]))
    assert scene.radius_m == pytest.approx([6.0])


def test_children_and_roots_by_hand(make_scene: MakeScene) -> None:
    """Children come in ascending order, whatever the order of their parents."""
    scene = make_scene([(0, 0, 0)] * 6, parent=[-1, 0, -1, 0, 2, 1])
    assert scene.roots.tolist() == [0, 2]
    assert [scene.children(node).tolist() for node in range(6)] == [[1, 3], [5], [4], [], [], []]
    assert not scene.flat
    assert make_scene([(0, 0, 0)] * 2).flat


def test_per_node_properties(make_scene: MakeScene, make_levels: MakeLevels) -> None:
    """Each node knows its type's number of levels, and whether it takes a resolution."""
    levels = make_levels([(9, 3, 1), (5, 2)], continuous=[False, True])
    scene = make_scene([(0, 0, 0)] * 3, kind=[1, 0, 1], levels=levels)
    assert scene.level_count.tolist() == [2, 3, 2]
    assert scene.continuous.tolist() == [True, False, True]
    assert len(scene) == 3


def test_a_scene_with_costs_shares_everything_else(make_scene: MakeScene) -> None:
    """Binding a cost model copies no array and leaves the scene itself without costs."""
    scene, costs = make_scene([(0, 0, 0)]), CostModel.of(1.0, {})
    bound = scene.with_costs(costs)
    assert bound.costs is costs
    assert scene.costs is None
    assert bound.center_m is scene.center_m
    assert bound.position_m is scene.position_m


def test_a_scene_travels_to_another_process(make_scene: MakeScene) -> None:
    """Pickled and back, a scene has the same spheres and children."""
    scene = make_scene([(1.0, 2.0, 3.0), (4.0, 5.0, 6.0)], parent=[-1, 0])
    again = pickle.loads(pickle.dumps(scene))
    assert (again.center_m == scene.center_m).all()
    assert again.children(0).tolist() == [1]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"kind": [0, 1]}, "node type_index: expected 0 to 0"),
        ({"kind": [-1, 0]}, "node type_index: expected 0 to 0"),
        ({"scale": [1.0, 0.0]}, "node scale: expected finite values"),
        ({"scale": [1.0, math.inf]}, "node scale: expected finite values"),
        ({"importance": [-1.0, 0.0]}, "node importance: expected finite values >= 0"),
        ({"orientation_xyzw": (0.0, 0.0, 0.0, 2.0)}, "expected unit quaternions"),
        ({"orientation_xyzw": (0.0, 0.0, 0.0, math.nan)}, "node orientation_xyzw: expected finite"),
        ({"parent": [0, -1]}, "node parent: expected -1 or an earlier node"),
        ({"parent": [-1, 1]}, "node parent: expected -1 or an earlier node"),
        ({"parent": [-1, -2]}, "node parent: expected -1 or an earlier node"),
        ({"radius_m": 0.0}, "type radius_m: expected finite values"),
        ({"radius_m": math.nan}, "type radius_m: expected finite values"),
        ({"center_m": (math.inf, 0.0, 0.0)}, "type center_m: expected finite values"),
    ],
)
def test_broken_scenes_are_refused(
    make_scene: MakeScene, changes: dict[str, object], message: str
) -> None:
    """Each rule has its own error, which names the array."""
    with pytest.raises(InputError, match=message):
        make_scene([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0)], **changes)


def test_scenes_without_places_are_refused(make_scene: MakeScene) -> None:
    """No nodes, a NaN position and motion of a node that is not there are errors."""
    with pytest.raises(InputError, match="expected at least one node"):
        make_scene(np.empty((0, 3)))
    with pytest.raises(InputError, match=r"node position_m: .*got nan at \(0, 2\)"):
        make_scene([(0.0, 0.0, math.nan)])
    motion = Motion(np.array([1]), np.ones(1), np.ones(1), np.ones(1))
    with pytest.raises(InputError, match="motion node: expected 0 to 0"):
        make_scene([(0.0, 0.0, 0.0)], motion=motion)


def test_types_need_levels_each(make_levels: MakeLevels) -> None:
    """Two names need two chains of levels."""
    with pytest.raises(InputError, match="levels: expected 2 types as in names, got 1"):
        ObjectTypes(("a", "b"), np.zeros((2, 3)), np.ones(2), make_levels())


def test_a_scene_of_nothing_is_refused(make_scene: MakeScene, make_levels: MakeLevels) -> None:
    """Three nodes without a triangle cannot tell policies apart; one triangle is something."""
    nothing = make_scene(np.zeros((3, 3)), levels=make_levels([(0, 0)]))
    with pytest.raises(InputError, match=r"expected something to draw, got 3 nodes without"):
        require_content(nothing)
    require_content(make_scene(np.zeros((3, 3)), levels=make_levels([(1, 0)])))
