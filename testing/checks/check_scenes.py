"""Small scenes, one of each kind that a policy may fit, and the cameras that look at them."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from ...base.predictors import LEVEL_PREDICTORS
from ...models.machine.cost import CostModel
from ...models.scene.camera import Camera
from ...models.scene.levels import LevelTable
from ...models.scene.scene import ObjectTypes, Scene

_CHAINS = ((4000.0, 1000.0, 250.0, 60.0), (2400.0, 900.0, 100.0), (600.0,))
_SOFT_CHAINS = ((5000.0, 1200.0, 300.0), (900.0, 90.0))
_LINEAR = {
    "draw_calls": 2e-3,
    "triangles": 1e-4,
    "shaded_samples": 1e-6,
    "framebuffer_pixels": 1e-7,
    "state_changes": 5e-3,
}
_ROOFLINE = {"triangles": 1e-4, "shaded_samples": 1e-5}


def camera_at(along_m: float, *, turned_deg: float = 0.0) -> Camera:
    """Return a level camera on the scenes' axis, looking along +y or turned to the left."""
    half = math.radians(turned_deg) / 2.0
    tilt = math.sqrt(0.5)  # a quarter turn about x: from looking down to looking ahead
    turn = (tilt * math.cos(half), tilt * math.sin(half), tilt * math.sin(half))
    return Camera((0.0, along_m, 0.0), (*turn, tilt * math.cos(half)), 640, 360, math.radians(60.0))


@cache
def scenes() -> tuple[Scene, ...]:
    """Return one scene each of levels, resolutions, both, and two trees."""
    plain = CostModel.of(0.2, _LINEAR)
    bent = CostModel.of(0.2, _LINEAR | {"vertices": 5e-5}, _ROOFLINE)
    mixed = (*_CHAINS, *_SOFT_CHAINS)
    soft = (False,) * len(_CHAINS) + (True,) * len(_SOFT_CHAINS)
    return (
        _street("levels", _CHAINS, (False,) * len(_CHAINS)).with_costs(plain),
        _street("resolutions", _SOFT_CHAINS, (True,) * len(_SOFT_CHAINS)).with_costs(plain),
        _street("levels and resolutions", mixed, soft).with_costs(bent),
        _facades().with_costs(plain),
        _groves().with_costs(bent),
    )


def lone_object(scene: Scene) -> Scene:
    """Return a scene of the first node of another one, without what stands below it."""
    one = slice(0, 1)
    return replace(
        scene,
        type_index=scene.type_index[one],
        position_m=scene.position_m[one],
        orientation_xyzw=scene.orientation_xyzw[one],
        scale=scene.scale[one],
        importance=scene.importance[one],
        parent=scene.parent[one],
        additive=scene.additive[one],
    )


def renumbered(scene: Scene, rng: np.random.Generator) -> tuple[Scene, np.ndarray]:
    """Return the scene with its nodes in another order, and the new number of each node, (N,).

    Parents stay before their children.
    """
    depth = np.zeros(len(scene), dtype=np.int64)
    for node, parent in enumerate(scene.parent.tolist()):
        depth[node] = depth[parent] + 1 if parent >= 0 else 0
    order = np.lexsort((rng.random(len(scene)), depth))
    number = np.empty(len(scene), dtype=np.int32)
    number[order] = np.arange(len(scene))
    parent = scene.parent[order]
    same = replace(
        scene,
        type_index=scene.type_index[order],
        position_m=scene.position_m[order],
        orientation_xyzw=scene.orientation_xyzw[order],
        scale=scene.scale[order],
        importance=scene.importance[order],
        parent=np.where(parent < 0, -1, number[parent]),
        additive=scene.additive[order],
    )
    return same, number


def _levels(
    chains: Sequence[Sequence[float]], continuous: Sequence[bool], error_m: Sequence[float] | None
) -> LevelTable:
    """Return the levels of chains of triangles, with vertices that fall more slowly."""
    triangles = np.concatenate([np.asarray(chain) for chain in chains])
    counts = np.zeros((len(triangles), len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("draw_calls")] = triangles > 0.0
    counts[:, LEVEL_PREDICTORS.index("triangles")] = triangles
    counts[:, LEVEL_PREDICTORS.index("vertices")] = 0.5 * triangles + 3.0 * np.sqrt(triangles)
    coarser = np.concatenate([np.arange(float(len(chain))) for chain in chains])
    return LevelTable(
        np.cumsum([0, *map(len, chains)]),
        counts,
        0.02 * np.square(coarser) if error_m is None else np.array(error_m),
        40.0 * triangles,
        np.asarray(continuous),
    )


def _scene(
    name: str,
    levels: LevelTable,
    kind: np.ndarray,
    position_m: np.ndarray,
    scale: np.ndarray,
    parent: np.ndarray | None = None,
    additive: np.ndarray | None = None,
) -> Scene:
    types, n = len(levels.level_count), len(kind)
    rng = np.random.default_rng(types + n)
    return Scene(
        name,
        ObjectTypes(
            tuple(f"type-{k}" for k in range(types)), np.zeros((types, 3)), np.ones(types), levels
        ),
        kind,
        position_m,
        np.tile((0.0, 0.0, 0.0, 1.0), (n, 1)),
        scale,
        rng.uniform(0.5, 2.0, n),
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
    return _scene(
        name, _levels(chains, continuous, None), kind, position_m, rng.uniform(0.6, 1.4, n)
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
    levels = _levels(((500.0,), (300.0,), (350.0,)), (False,) * 3, (0.8, 0.3, 0.0))
    root = parent.copy()
    while (root >= len(roots_m)).any():
        root = np.where(root >= len(roots_m), parent[root], root)
    additive = (root == 1) | (np.arange(len(depth)) == 1)
    return _scene("tree", levels, depth, position_m, radius_m, parent, additive)


def _groves() -> Scene:
    """Return a tree of terrain, and one without geometry above groups of resolutions."""
    roots_m = np.array([(-6.0, 25.0, -1.0), (6.0, 30.0, 0.0)])
    depth, parent, position_m, radius_m = _grown(roots_m, 1, 8.0)
    chains = ((250.0,), (200.0,), (0.0,), (3000.0, 700.0, 60.0))
    levels = _levels(chains, (False, False, False, True), (0.5, 0.0, 0.0, 0.0, 0.05, 0.3))
    wooded = (parent == 1) | (np.arange(len(depth)) == 1)
    return _scene("tree of groups", levels, depth + 2 * wooded, position_m, radius_m, parent)
