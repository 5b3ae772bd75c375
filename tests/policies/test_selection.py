"""The contract of a selection: one deliberately broken selection for each message."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.tree import Tree
from lodbench.policies.selection import Selection, Work, find_violation

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]
CANDIDATES = np.array([0, 1, 3], dtype=np.int32)


@pytest.fixture(scope="module")
def mixed(make_scene: MakeScene, make_levels: MakeLevels) -> Scene:
    """Return five nodes: 0, 1 and 4 have three levels, 2 and 3 resolutions from 0.1."""
    levels = make_levels([(100, 50, 10), (100, 10)], continuous=[False, True])
    return make_scene([(0, 0, 0)] * 5, kind=[0, 0, 1, 1, 0], levels=levels)


def check(scene: Scene, ids: Any = CANDIDATES, detail: Any = (0.0, 2.0, 0.5), **more: Any) -> Any:
    """Return the violation of a selection with the given parts; lists of details become arrays."""
    given = np.array(detail) if type(detail) in {list, tuple} else detail
    return find_violation(Selection(ids, given, **more), CANDIDATES, scene)


def test_good_selections_pass(mixed: Scene) -> None:
    """Everything, a part in another order, nothing, and borrowing within a type are allowed."""
    assert check(mixed) is None
    assert check(mixed, np.array([3, 0]), (0.1, 2.0)) is None
    assert check(mixed, CANDIDATES.astype(np.int64)) is None
    assert check(mixed, np.array([], dtype=int), np.array([])) is None
    assert check(mixed, holder=np.array([1, 1, 2]), predicted_ms=3.0) is None


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"ids": [0, 1, 3]}, "ids: expected a one-dimensional numpy array, got list"),
        ({"ids": CANDIDATES[None]}, "ids: expected a one-dimensional numpy array, got ndarray"),
        ({"ids": CANDIDATES * 1.0}, "ids: expected integers, got float64"),
        ({"detail": "fine"}, "detail: expected a one-dimensional numpy array, got str"),
        ({"detail": np.zeros(3, int)}, "detail: expected float64, got int"),
        ({"detail": np.zeros(3, np.float32)}, "detail: expected float64, got float32"),
        ({"detail": [0.0, 1.0]}, "detail: expected 3 values as in ids, got 2"),
        ({"detail": [np.nan, 0.0, 1.0]}, "detail of node 0: expected a level from 0 to 2, got nan"),
        ({"detail": [0.0, 3.0, 1.0]}, "detail of node 1: expected a level from 0 to 2, got 3"),
        ({"detail": [0.0, -1.0, 1.0]}, "detail of node 1: expected a level from 0 to 2, got -1"),
        ({"detail": [0.5, 0.0, 1.0]}, "detail of node 0: expected a level from 0 to 2, got 0.5"),
        ({"detail": [0.0, np.inf, 1.0]}, "detail of node 1: expected a level from 0 to 2, got inf"),
        ({"detail": [0.0, 0.0, 0.05]}, "node 3: expected a resolution from 0.1 to 1, got 0.05"),
        ({"detail": [0.0, 0.0, 1.01]}, "node 3: expected a resolution from 0.1 to 1, got 1.01"),
        ({"detail": [0.0, 0.0, np.nan]}, "node 3: expected a resolution from 0.1 to 1, got nan"),
        ({"ids": np.array([0, 1, 9])}, "ids: expected 0 to 4, got 0 to 9"),
        ({"ids": np.array([-1, 1, 3])}, "ids: expected 0 to 4, got -1 to 3"),
        ({"ids": np.array([0, 0, 3])}, "ids: expected distinct nodes, got a node twice"),
        ({"ids": np.array([0, 4, 3])}, "ids: expected candidates of the view, got node 4"),
        ({"holder": np.zeros(2, int)}, "holder: expected 3 values as in ids, got 2"),
        ({"holder": np.zeros(3)}, "holder: expected integers, got float64"),
        ({"holder": np.array([0, 1, 7])}, "holder: expected 0 to 4, got 0 to 7"),
        ({"holder": np.array([0, 1, 1])}, "holder of node 3: expected its type, got node 1 of"),
        ({"work": 7}, "work: expected a Work, got int"),
        ({"work": Work(-1)}, "work: expected a finite number of objects_visited >= 0, got -1"),
        ({"work": Work(0, np.nan)}, "work: expected a finite number of comparisons >= 0, got nan"),  # pyright: ignore[reportArgumentType]  # broken on purpose
        ({"work": Work(0, 0, None)}, "work: expected a finite number of iterations >= 0, got None"),  # pyright: ignore[reportArgumentType]  # broken on purpose
        ({"predicted_ms": "soon"}, "predicted_ms: expected milliseconds >= 0 or NaN, got soon"),
        ({"predicted_ms": -1.0}, "predicted_ms: expected milliseconds >= 0 or NaN, got -1"),
    ],
)
def test_each_broken_selection_has_its_message(
    mixed: Scene, parts: dict[str, Any], message: str
) -> None:
    """A single fault in an otherwise good selection is named, with what was expected and got."""
    assert message in check(mixed, **parts)


def test_something_else_than_a_selection(mixed: Scene) -> None:
    """None and a bare array are refused by their type."""
    assert find_violation(None, CANDIDATES, mixed) == "expected a Selection, got NoneType"
    got = find_violation(np.zeros(3), CANDIDATES, mixed)
    assert got == "expected a Selection, got ndarray"


def test_a_scene_of_discrete_types_alone(make_scene: MakeScene) -> None:
    """Without continuous types the same faults are found."""
    scene = make_scene([(0, 0, 0)] * 4)
    assert check(scene, detail=[0.0, 1.0, 2.0]) is None
    for bad in (3.0, -1.0, 0.5, np.nan):
        assert f"node 3: expected a level from 0 to 2, got {bad:g}" in check(
            scene, detail=[0.0, 1.0, bad]
        )


def test_a_front_of_a_tree(make_scene: MakeScene, make_levels: MakeLevels) -> None:
    """In a tree any nodes may be drawn, but none below another that replaces it."""
    levels = make_levels([(10,)])
    scene = make_scene([(0, 0, 0)] * 5, levels=levels, parent=[-1, 0, 0, 1, 1])
    tree = Tree(scene)
    roots = scene.roots

    def violation(*ids: int) -> str | None:
        selection = Selection(np.array(ids), np.zeros(len(ids)))
        return find_violation(selection, roots, scene, tree)

    assert violation(0) is None
    assert violation(2, 3, 4) is None
    assert violation(3, 2) is None
    assert violation(0, 4) == "ids: expected a front, got node 4 below another that replaces it"
    added = make_scene([(0, 0, 0)] * 2, levels=levels, parent=[-1, 0], additive=True)
    both = Selection(np.array([0, 1]), np.zeros(2))
    assert find_violation(both, added.roots, added, Tree(added)) is None
