"""The triangles of a frame in camera coordinates, and how fine the node is that each belongs to."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...models.meshes.geometry import Geometry
from ...models.meshes.shapes import grid_faces
from ...models.scene.camera import projected_area_px
from ...models.scene.rotation import rotate
from ...models.scene.tree import Tree
from .snapshot import Snapshot

_CHUNK = 400_000  # triangles at once
_OCTAHEDRON = np.array(((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)))
_OCTAHEDRON_FACES = np.array(
    ((0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5))
)
_TILE_CELLS = 8  # along a side of a square
_NEIGHBOURS = 6  # centres of leaves that the height of a point is taken from
_LIFT, _SPLAT_LIFT_M = 0.005, 60.0  # of the radius; trees show above the ground below them


def fineness(shot: Snapshot) -> FloatArray:
    """Return how fine each drawn node is, (m,), from 0 for coarsest to 1 for finest.

    Of a chain, its level; of a continuous type, the logarithm of its resolution; of a node of a
    tree with one level, its depth.
    """
    scene, levels = shot.scene, shot.scene.types.levels
    kind = scene.type_index[shot.ids]
    last = levels.level_count[kind] - 1
    chain = 1.0 - shot.detail / np.maximum(last, 1)
    least = np.log(np.maximum(levels.min_resolution[kind], 1e-6))
    soft = 1.0 - np.log(np.maximum(shot.detail, 1e-6)) / np.minimum(least, -1e-6)
    value = np.where(levels.continuous[kind], soft, chain)
    if not scene.flat:
        depth = Tree(scene).depth
        deep = depth[shot.ids] / max(1, int(depth.max()))
        value = np.where(levels.continuous[kind] | (last > 0), value, deep)
    return np.clip(value, 0.0, 1.0)


def _level_rows(shot: Snapshot, geometry: Geometry) -> IntArray:
    """Return which mesh each drawn node is drawn with, (m,)."""
    levels = shot.scene.types.levels
    row, fraction = levels.position(shot.scene.type_index[shot.ids], shot.detail)
    return np.minimum(row + np.round(fraction).astype(np.int64), len(geometry) - 1)


def rows_as_seen(shot: Snapshot, geometry: Geometry, most_per_px: float) -> tuple[IntArray, int]:
    """Return which mesh each drawn node is drawn with, (m,), and how many triangles that makes.

    It is that of its level; of a node with more triangles than `most_per_px` for each pixel that
    its sphere covers, that of the coarsest level of its type that still has so many.
    """
    scene, row = shot.scene, _level_rows(shot, geometry)
    local_m = shot.camera.to_camera(shot.centers_m[:, shot.ids])
    distance_m = np.linalg.norm(local_m, axis=0)
    area_px = projected_area_px(local_m[2], distance_m, scene.radius_m[shot.ids], shot.camera)
    triangles = np.array([len(mesh.faces) for mesh in geometry], dtype=np.int64)
    coarsest = scene.types.levels.start[1:][scene.type_index[shot.ids]] - 1
    while True:
        next_row = np.minimum(row + 1, coarsest)
        coarser = (next_row > row) & (triangles[next_row] >= most_per_px * area_px)
        if not coarser.any():
            return row, int(triangles[row].sum())
        row = np.where(coarser, next_row, row)


def node_triangles(
    shot: Snapshot, geometry: Geometry, row: IntArray | None = None
) -> Iterator[tuple[FloatArray, IntArray]]:
    """Yield corners (n, 3, 3) in camera coordinates, and rows of the drawn nodes, (n,).

    Without geometry, nodes are octahedra in their spheres, or draped squares in those of a tree.

    Parameters
    ----------
    row
        Which mesh each drawn node is drawn with, (m,); None for that of its level.
    """
    if len(shot.ids) == 0:
        return
    if not geometry:
        yield _stand_ins(shot)
        return
    if row is None:
        row = _level_rows(shot, geometry)
    order = np.argsort(row, kind="stable")
    for level, start in zip(*np.unique(row[order], return_index=True), strict=True):
        mesh = geometry[int(level)]
        nodes = order[start:][row[order[start:]] == level]
        step = max(1, _CHUNK // len(mesh.faces))
        for first in range(0, len(nodes), step):
            some = nodes[first : first + step]
            points = _placed(shot, some, mesh.vertices.astype(np.float64))
            corner = points[:, mesh.faces].reshape(-1, 3, 3)
            yield corner, np.repeat(some, len(mesh.faces))


def _placed(shot: Snapshot, rows: IntArray, vertices: FloatArray) -> FloatArray:
    """Return a type's vertices in camera coordinates for each node, (n, V, 3)."""
    scene, ids = shot.scene, shot.ids[rows]
    count, size = len(ids), len(vertices)
    turn = np.repeat(scene.orientation_xyzw[ids], size, axis=0)
    turned = rotate(turn, np.tile(vertices, (count, 1))).reshape(count, size, 3)
    moved = shot.centers_m[:, ids].T - scene.center_m[ids]
    place = scene.position_m[ids] + moved
    points = turned * scene.scale[ids, None, None] + place[:, None]
    return shot.camera.to_camera(points.reshape(-1, 3).T).T.reshape(count, size, 3)


def _stand_ins(shot: Snapshot) -> tuple[FloatArray, IntArray]:
    scene = shot.scene
    center = shot.centers_m[:, shot.ids].T
    radius = scene.radius_m[shot.ids][:, None]
    if scene.flat:
        points, faces = center[:, None] + radius[..., None] * _OCTAHEDRON, _OCTAHEDRON_FACES
    else:
        points, faces = _draped(shot, center, radius)
    seen = shot.camera.to_camera(points.reshape(-1, 3).T).T.reshape(len(center), -1, 3)
    return seen[:, faces].reshape(-1, 3, 3), np.repeat(np.arange(len(center)), len(faces))


def _draped(shot: Snapshot, center: FloatArray, radius: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return points (m, P, 3) and faces of squares in the spheres of nodes of a tree.

    They are laid over the centres of its leaves, so that terrain shows its relief.
    """
    from scipy.spatial import KDTree

    cells = np.arange(_TILE_CELLS + 1) / _TILE_CELLS - 0.5
    square = np.stack(np.meshgrid(cells, cells, indexing="ij"), axis=-1).reshape(-1, 2)
    plan = center[:, None, :2] + radius[..., None] * np.sqrt(2.0) * square
    leaves = shot.scene.center_m[Tree(shot.scene).leaf]
    count = min(_NEIGHBOURS, len(leaves))
    found: Any = KDTree(leaves[:, :2]).query(plan.reshape(-1, 2), k=[*range(1, count + 1)])
    gap, near = np.asarray(found[0], dtype=np.float64), np.asarray(found[1], dtype=np.int64)
    weight = np.exp(-2.0 * (gap / np.maximum(gap[:, -1:], 1e-9)) ** 2)
    height = (weight * leaves[near, 2]).sum(axis=1) / weight.sum(axis=1)
    lift = _LIFT * radius + np.where(shot.scene.continuous[shot.ids], _SPLAT_LIFT_M, 0.0)[:, None]
    points = np.concatenate((plan, (height.reshape(len(center), -1) + lift)[..., None]), axis=2)
    return points, grid_faces(_TILE_CELLS, _TILE_CELLS)
