"""Small scenes, one of each kind that a policy may fit, and what they are built with."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from ...base.predictors import LEVEL_PREDICTORS
from ...models.scene.levels import LevelTable
from ...models.scene.scene import ObjectTypes, Scene

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
    names = ("type_index", "position_m", "orientation_xyzw", "scale", "importance", "additive")
    columns: dict[str, Any] = {name: getattr(scene, name)[nodes] for name in names}
    return replace(scene, parent=parent, **columns)


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


def trees(
    roots_m: np.ndarray, radius_m: np.ndarray, layers: Sequence[int]
) -> tuple[np.ndarray, ...]:
    """Return depth, parent, position and radius of trees of four nested children a node.

    A tree has as many layers below its root; no two nodes are alike.
    """
    position_m, radii_m, left = list(roots_m), list(radius_m), list(layers)
    parent, depth = [-1] * len(left), [0] * len(left)
    node = 0
    while node < len(parent):
        for corner in range(4 if left[node] else 0):
            side = np.array([(corner & 1) - 0.5, (corner >> 1) - 0.5, 0.0])
            step = 1.0 + 0.031 * corner + 0.0017 * node
            position_m.append(position_m[node] + side * radii_m[node] * step)
            radii_m.append(0.5 * radii_m[node] * (1.0 + 0.011 * corner))
            parent.append(node)
            depth.append(depth[node] + 1)
            left.append(left[node] - 1)
        node += 1
    return np.array(depth), np.array(parent), np.array(position_m), np.array(radii_m)


def _facades() -> Scene:
    """Return trees of discrete nodes, one of which keeps its root beside the children."""
    roots_m = np.array([(-7.0, 22.0, 0.0), (8.0, 38.0, 1.0), (-3.0, 66.0, -1.0)])
    depth, parent, position_m, radius_m = trees(roots_m, np.full(3, 6.0), (2, 2, 2))
    levels = level_table(((500.0,), (300.0,), (350.0,)), (False,) * 3, (0.8, 0.3, 0.0))
    additive = np.arange(len(depth)) == 1
    return scene_of("tree", levels, depth, position_m, radius_m, parent=parent, additive=additive)


def _groves() -> Scene:
    """Return a tree of terrain, and one without geometry above groups of resolutions."""
    roots_m = np.array([(-6.0, 25.0, -1.0), (6.0, 30.0, 0.0)])
    depth, parent, position_m, radius_m = trees(roots_m, np.full(2, 8.0), (1, 1))
    chains = ((250.0,), (200.0,), (0.0,), (3000.0, 700.0, 60.0))
    levels = level_table(chains, (False, False, False, True), (0.5, 0.0, 0.0, 0.0, 0.05, 0.3))
    wooded = (parent == 1) | (np.arange(len(depth)) == 1)
    kind = depth + 2 * wooded
    return scene_of("tree of groups", levels, kind, position_m, radius_m, parent=parent)
