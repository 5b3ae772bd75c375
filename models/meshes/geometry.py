"""Geometry of levels of detail, as a renderer would upload it."""

from dataclasses import dataclass
from typing import Annotated, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import IntArray, freeze
from ...base.errors import InputError

Float32Array: TypeAlias = NDArray[np.float32]

VERTEX_BYTES = 32
"""Position, normal and texture coordinate, float32."""

INDEX_BYTES = 4


@dataclass(frozen=True, slots=True)
class LevelMesh:
    """One level of one type: V drawn vertices and F triangles in P material parts.

    Attributes
    ----------
    vertices : (V, 3) float32
        Metres in the type's own frame, before the scale of a node.
    normals : (V, 3) float32
    faces : (F, 3) int32
        Part ``p`` owns rows ``part_start[p]`` to ``part_start[p + 1]``.
    part_start : (P + 1,) int32
    uv : (V, 2) float32, or None where the type has no texture coordinates
    """

    vertices: Annotated[Float32Array, np.float32, "V", 3]
    normals: Annotated[Float32Array, np.float32, "V", 3]
    faces: Annotated[IntArray, np.int32, "F", 3]
    part_start: Annotated[IntArray, np.int32, "P"]
    uv: Annotated[Float32Array | None, np.float32, "V", 2] = None

    def __post_init__(self) -> None:
        v, f, p = len(self.vertices), len(self.faces), len(self.part_start)
        freeze(self, "mesh", V=v, F=f, P=p)
        if f == 0 or self.faces.min() < 0 or self.faces.max() >= v:
            raise InputError(f"mesh faces: expected indices of {v} vertices, got others or none")
        start = self.part_start
        if p < 2 or start[0] != 0 or start[-1] != f or (np.diff(start) < 0).any():
            raise InputError(f"mesh part_start: expected to rise from 0 to {f} faces")

    @property
    def byte_count(self) -> int:
        """Bytes of the vertex and index buffers."""
        return VERTEX_BYTES * len(self.vertices) + INDEX_BYTES * 3 * len(self.faces)


Geometry: TypeAlias = tuple[LevelMesh, ...]
"""One mesh for each row of a scene's level table."""
