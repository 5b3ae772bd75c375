"""Small scenes, one of each kind that a policy may fit, and what they are built with."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from ..base.predictors import LEVEL_PREDICTORS
from ..models.scene.levels import LevelTable
from ..models.scene.scene import ObjectTypes, Scene

_CHAINS = ((4000.0, 1000.0, 250.0, 60.0), (2400.0, 900.0, 100.0), (600.0,))
_SOFT_CHAINS = ((5000.0, 1200.0, 300.0), (900.0, 90.0))


@cache
def small_scenes() -> tuple[Scene, ...]:
    """Return one scene each of levels, resolutions, both, and two trees."""
    mixed = (*_CHAINS, *_SOFT_CHAINS)
    soft = (False,) * len(_CHAINS) + (True,) * len(_SOFT_CHAINS)
    return (
        _street("levels", _CHAINS, (False,) * len(_CHAINS)),
        _street("resolutions", _SOFT_CHAINS, (True,) * len(_SOFT_CHAINS)),
        _street("levels and resolutions", mixed, soft),
        _facades(),
        _groves(),
    )


def lone_object(scene: Scene) -> Scene:
    """Return a scene of the first node of another one, without what stands below it."""
    return _of_nodes(scene, np.zeros(1, dtype=np.int64), np.full(1, -1))


def renumbered(scene: Scene, seed: int) -> tuple[Scene, np.ndarray]:
    """Return the scene with its nodes in another order, and the old number of each node, (N,).

    Parents stay before their children.
    """
    depth = np.zeros(len(scene), dtype=np.int64)
    for node, parent in enumerate(scene.parent.tolist()):
        depth[node] = depth[parent] + 1 if parent >= 0 else 0
    order = np.lexsort((np.random.default_rng(seed).random(len(scene)), depth)).astype(np.int32)
    number = np.argsort(order)
    parent = scene.parent[order]
    return _of_nodes(scene, order, np.where(parent < 0, -1, number[parent])), order


def _of_nodes(scene: Scene, nodes: np.ndarray, parent: np.ndarray) -> Scene:
    return replace(
        scene,
        type_index=scene.type_index[nodes],
        position_m=scene.position_m[nodes],
        orientation_xyzw=scene.orientation_xyzw[nodes],
        scale=scene.scale[nodes],
        importance=scene.importance[nodes],
        parent=parent,
        additive=scene.additive[nodes],
    )


def level_table(
    chains: Sequence[Sequence[float]],
    continuous: Sequence[bool],
    error_m: Sequence[float] | None = None,
) -> LevelTable:
    """Return the levels of chains of triangles, with vertices that fall more slowly.

    Errors are those given, else a centimetre times the square of a level's index.
    """
    triangles = np.concatenate([np.asarray(chain) for chain in chains])
    counts = np.zeros((len(triangles), len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("draw_calls")] = triangles > 0.0
    counts[:, LEVEL_PREDICTORS.index("triangles")] = triangles
    counts[:, LEVEL_PREDICTORS.index("vertices")] = 0.5 * triangles + 3.0 * np.sqrt(triangles)
    coarser = np.concatenate([np.arange(float(len(chain))) for chain in chains])
    return LevelTable(
        np.cumsum([0, *map(len, chains)]),
        counts,
        0.01 * np.square(coarser) if error_m is None else np.array(error_m),
        40.0 * triangles,
        np.asarray(continuous),
    )


def scene_of(
    name: str,
    levels: LevelTable,
    kind: np.ndarray,
    position_m: np.ndarray,
    scale: np.ndarray,
    *,
    parent: np.ndarray | None = None,
    additive: np.ndarray | None = None,
) -> Scene:
    """Return nodes of radius `scale`, turned nowhere, no two of the same importance."""
    types, n = len(levels.level_count), len(kind)
    names = tuple(f"type-{k}" for k in range(types))
    return Scene(
        name,
        ObjectTypes(names, np.zeros((types, 3)), np.ones(types), levels),
        kind,
        position_m,
        np.tile((0.0, 0.0, 0.0, 1.0), (n, 1)),
        scale,
        np.linspace(1.0, 1.5, n),
        np.full(n, -1) if parent is None else parent,
        np.zeros(n, dtype=np.bool_) if additive is None else additive,
    )


def _street(name: str, chains: Sequence[Sequence[float]], continuous: Sequence[bool]) -> Scene:
    """Return 24 objects on both sides of the axis, no two alike."""
    rng = np.random.default_rng(len(chains))
    n = 24
    position_m = np.column_stack(
        (
            rng.uniform(1.5, 9.0, n) * rng.choice((-1.0, 1.0), n),
            np.linspace(5.0, 70.0, n) + rng.uniform(-1.0, 1.0, n),
            rng.uniform(-1.0, 1.0, n),
        )
    )
    kind = np.arange(n) % len(chains)
    return scene_of(
        name, level_table(chains, continuous), kind, position_m, rng.uniform(0.6, 1.4, n)
    )


def _grown(roots_m: np.ndarray, depth: int, size_m: float) -> tuple[np.ndarray, ...]:
    """Return depth, parent, position and radius of trees of four nested children a node."""
    rng = np.random.default_rng(depth)
    layer = np.zeros(len(roots_m), dtype=np.int64)
    columns = [(layer, np.full(len(roots_m), -1), roots_m, np.full(len(roots_m), size_m))]
    first = 0
    for at in range(1, depth + 1):
        _, _, above_m, radius_m = columns[-1]
        parent = np.repeat(np.arange(len(above_m)), 4)
        corner = np.tile([(-1, -1, 0), (-1, 1, 0), (1, -1, 0), (1, 1, 0)], (len(above_m), 1))
        away = 0.4 * corner + rng.uniform(-0.02, 0.02, (len(parent), 3))
        position_m = above_m[parent] + away * radius_m[parent, None]
        radius_m = 0.4 * radius_m[parent]
        columns.append((np.full(len(parent), at), parent + first, position_m, radius_m))
        first += len(above_m)
    return tuple(np.concatenate(column) for column in zip(*columns, strict=True))


def _facades() -> Scene:
    """Return trees of discrete nodes, one of which keeps its nodes beside their children."""
    roots_m = np.array([(-7.0, 22.0, 0.0), (8.0, 38.0, 1.0), (-3.0, 66.0, -1.0)])
    depth, parent, position_m, radius_m = _grown(roots_m, 2, 6.0)
    levels = level_table(((500.0,), (300.0,), (350.0,)), (False,) * 3, (0.8, 0.3, 0.0))
    root = parent.copy()
    while (root >= len(roots_m)).any():
        root = np.where(root >= len(roots_m), parent[root], root)
    additive = (root == 1) | (np.arange(len(depth)) == 1)
    return scene_of("tree", levels, depth, position_m, radius_m, parent=parent, additive=additive)


def _groves() -> Scene:
    """Return a tree of terrain, and one without geometry above groups of resolutions."""
    roots_m = np.array([(-6.0, 25.0, -1.0), (6.0, 30.0, 0.0)])
    depth, parent, position_m, radius_m = _grown(roots_m, 1, 8.0)
    chains = ((250.0,), (200.0,), (0.0,), (3000.0, 700.0, 60.0))
    levels = level_table(chains, (False, False, False, True), (0.5, 0.0, 0.0, 0.0, 0.05, 0.3))
    wooded = (parent == 1) | (np.arange(len(depth)) == 1)
    kind = depth + 2 * wooded
    return scene_of("tree of groups", levels, kind, position_m, radius_m, parent=parent)
