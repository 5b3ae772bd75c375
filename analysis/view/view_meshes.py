"""The meshes of a viewer: of the levels that are drawn, as many as a page should carry."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import IntArray
from ...models.meshes.geometry import Geometry, LevelMesh
from ...models.scene.scene import Scene

MOST_BYTES = 8_000_000
"""Of meshes that a page carries, before they are compressed."""
MOST_MESHES = 600
"""Each is a draw call of a viewer."""

_GRID = 65_535  # steps along each side of the box about a mesh


@dataclass(frozen=True, slots=True)
class ViewMeshes:
    """Meshes of a page.

    Attributes
    ----------
    mesh_of_row : (L,) int32
        Which mesh stands for each row of the level table, -1 for none.
    arrays : dict of str to array
        Of mesh m ``m/vertices`` (V, 3) uint16 in its box, and ``m/faces`` (F, 3).
    boxes : list of (low, size)
        Of each mesh.
    wanted, own : int
        Levels that are drawn, and those of them that are shown by their own mesh.
    """

    mesh_of_row: IntArray
    arrays: dict[str, NDArray[Any]]
    boxes: list[tuple[list[float], list[float]]]
    wanted: int
    own: int


def choose_meshes(scene: Scene, geometry: Geometry, drawn_rows: IntArray) -> ViewMeshes:
    """Return meshes for the rows that are drawn, small ones first, within `MOST_BYTES`.

    A row without room is shown by the mesh of the next coarser level of its type that has some.
    """
    mesh_of_row = np.full(len(scene.types.levels.error_m), -1, dtype=np.int32)
    rows: list[int] = np.unique(drawn_rows).tolist() if geometry else []
    arrays: dict[str, NDArray[Any]] = {}
    boxes: list[tuple[list[float], list[float]]] = []
    room = MOST_BYTES
    for row in sorted(rows, key=lambda at: (_size_bytes(geometry[at]), at)):
        mesh = geometry[row]
        room -= _size_bytes(mesh)
        if room < 0 or len(boxes) == MOST_MESHES:
            break
        low = mesh.vertices.min(axis=0).astype(np.float64)
        size = np.maximum(np.ptp(mesh.vertices, axis=0).astype(np.float64), 1e-9)
        mesh_of_row[row] = at = len(boxes)
        grid = np.rint((mesh.vertices - low) / size * _GRID)
        arrays[f"mesh{at}/vertices"] = grid.astype(np.uint16)
        arrays[f"mesh{at}/faces"] = mesh.faces.astype(_index_type(mesh))
        boxes.append((low.tolist(), size.tolist()))
    own = len(boxes)
    ends = scene.types.levels.start[1:][scene.types.levels.type_of_level]
    for row in rows:
        coarser = mesh_of_row[row : int(ends[row])]
        if mesh_of_row[row] < 0 and (coarser >= 0).any():
            mesh_of_row[row] = coarser[coarser >= 0][0]
    return ViewMeshes(mesh_of_row, arrays, boxes, len(rows), own)


def _index_type(mesh: LevelMesh) -> type[Any]:
    return np.uint16 if len(mesh.vertices) <= _GRID else np.uint32


def _size_bytes(mesh: LevelMesh) -> int:
    return 6 * len(mesh.vertices) + 3 * np.dtype(_index_type(mesh)).itemsize * len(mesh.faces)
