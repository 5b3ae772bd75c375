"""Scenes of hierarchical levels of detail: every node of every tree is a node of the scene."""

from collections.abc import Sequence

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ..layouts.scene_builder import PlacementOptions, place_kinds
from ..meshes.geometry import Geometry
from ..scene.levels import LevelTable
from ..scene.rotation import turn_about_z
from ..scene.scene import ObjectTypes, Scene
from .hlod_tree import Hlod


def hlod_scene(
    name: str,
    trees: Sequence[Hlod],
    kind: IntArray,
    position_m: FloatArray,
    yaw_rad: FloatArray,
    scale: FloatArray,
) -> tuple[Scene, Geometry]:
    """Return a hierarchical scene of B trees, and the mesh of each type.

    Types are the nodes of the distinct trees; roots stand first.

    Parameters
    ----------
    kind : (B,) which of `trees` stands in each place
    position_m : (B, 3)
    yaw_rad, scale : (B,)
    """
    sizes = np.array([len(tree.meshes) for tree in trees])
    first_type = np.concatenate(([0], np.cumsum(sizes)))
    copy = np.repeat(np.arange(len(kind)), sizes[kind])
    chosen: list[int] = kind.tolist()
    placed = [trees[k] for k in chosen]
    local = np.concatenate([np.arange(len(tree.meshes)) for tree in placed])
    depth = np.concatenate([tree.depth for tree in placed])
    parent = np.concatenate([tree.parent for tree in placed])
    begin = np.concatenate(([0], np.cumsum(sizes[kind])))[:-1]
    parent = np.where(parent < 0, -1, parent + begin[copy])
    order = np.argsort(depth, kind="stable")
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    parent = np.where(parent < 0, -1, rank[parent])[order]
    copy, local = copy[order], local[order]
    scene = Scene.of(
        name,
        _types(trees),
        first_type[kind[copy]] + local,
        position_m[copy],
        turn_xyzw=turn_about_z(yaw_rad[copy]),
        scale=scale[copy],
        parent=parent,
    )
    return scene, tuple(mesh for tree in trees for mesh in tree.meshes)


def place_trees(
    name: str, trees: Sequence[Hlod], options: PlacementOptions, rng: np.random.Generator
) -> tuple[Scene, Geometry]:
    """Place trees by a layout, in equal shares, and return the scene with its geometry.

    Raises `InputError` if the layout cannot hold them.
    """
    radius = np.array([_footprint_radius_m(tree) for tree in trees])
    kind, plan, yaw, scale = place_kinds(radius, options, rng)
    return hlod_scene(name, trees, kind, np.column_stack((plan, np.zeros(len(plan)))), yaw, scale)


def _footprint_radius_m(tree: Hlod) -> float:
    """Return the radius of the circle about the origin that holds the tree, seen from above."""
    corners = np.maximum(np.abs(tree.low_m), np.abs(tree.high_m))[:, :2]
    return float(np.linalg.norm(corners, axis=1).max())


def _types(trees: Sequence[Hlod]) -> ObjectTypes:
    """Return a type for each node of each tree, in a sphere about its box and its children's.

    So nothing below a node that is out of view is in view: a child's sphere stands out of its
    parent's even where its box does not.
    """
    low = np.concatenate([tree.low_m for tree in trees])
    high = np.concatenate([tree.high_m for tree in trees])
    nodes = len(low)
    names = tuple(f"{tree.name}/{i}" for tree in trees for i in range(len(tree.meshes)))
    levels = LevelTable(
        np.arange(nodes + 1),
        np.concatenate([tree.counts for tree in trees]),
        np.concatenate([tree.error_m for tree in trees]),
        np.concatenate([tree.bytes for tree in trees]),
        np.zeros(nodes, dtype=np.bool_),
    )
    center_m, radius = (low + high) / 2.0, np.linalg.norm(high - low, axis=1) / 2.0
    first = np.cumsum([0, *(len(tree.meshes) for tree in trees)])
    for tree, begin in zip(trees, first.tolist(), strict=False):
        for node in range(len(tree.meshes) - 1, 0, -1):  # parents stand before their children
            child, parent = begin + node, begin + int(tree.parent[node])
            gap_m = float(np.linalg.norm(center_m[child] - center_m[parent]))
            radius[parent] = max(radius[parent], gap_m + radius[child])
    return ObjectTypes(
        names,
        center_m,
        radius,
        levels,
        surface_m2=np.concatenate([tree.surface_m2 for tree in trees]),
        normal=np.concatenate([tree.normal for tree in trees]),
    )
