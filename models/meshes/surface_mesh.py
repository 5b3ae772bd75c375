"""A cleaned triangle mesh, indexed by position, from which levels of detail are made."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, freeze, require_finite
from ...base.errors import InputError

_FARTHEST = 1e30  # in units of the file: squares of areas of larger meshes overflow


@dataclass(frozen=True, slots=True)
class MeshPart:
    """Triangles of one material as a file holds them; vertices (v, 3), faces (f, 3), uv (v, 2)."""

    vertices: FloatArray
    faces: IntArray
    material: int = 0
    textured: bool = False
    uv: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class SurfaceMesh:
    """V distinct positions, F triangles and P material parts.

    Attributes
    ----------
    positions : (V, 3) float64
    faces : (F, 3) int32
    part : (F,) int32
        Material part of each triangle.
    textured : (P,) bool
    uv : (U, 2) float64
        Distinct texture coordinates; one row of zeros where the mesh has none.
    uv_index : (F, 3) int32
        Texture coordinate of each corner; differs about a vertex where a seam runs.
    texture_bytes : float
    dropped : int
        Degenerate and duplicate triangles that were left out.
    """

    name: str
    positions: Annotated[FloatArray, np.float64, "V", 3]
    faces: Annotated[IntArray, np.int32, "F", 3]
    part: Annotated[IntArray, np.int32, "F"]
    textured: Annotated[BoolArray, np.bool_, "P"]
    uv: Annotated[FloatArray, np.float64, "U", 2]
    uv_index: Annotated[IntArray, np.int32, "F", 3]
    texture_bytes: float = 0.0
    dropped: int = 0

    def __post_init__(self) -> None:
        v, f, p, u = map(len, (self.positions, self.faces, self.textured, self.uv))
        freeze(self, "mesh", V=v, F=f, P=p, U=u)

    @property
    def has_uv(self) -> bool:
        """Whether the mesh has texture coordinates."""
        return len(self.uv) > 1

    def stand(
        self,
        *,
        y_up: bool,
        height_m: float | None = None,
        unit_m: float = 1.0,
        keep_origin: bool = False,
    ) -> "Stand":
        """Return how the mesh comes to stand on the ground, z up, in metres.

        Raises `InputError` if the mesh is flat, so that no scale gives it the height.

        Parameters
        ----------
        y_up : whether y points up in the file, and becomes z by a quarter turn about x
        height_m : height to scale to; if None, file units are `unit_m` metres
        keep_origin : whether the file's origin stays the origin; else the foot of the box is at
            z = 0 and its middle on the z axis
        """
        points = _z_up(self.positions, y_up=y_up)
        low, high = points.min(axis=0), points.max(axis=0)
        size = high - low
        scale = unit_m
        if height_m is not None:
            if size[2] < 1e-6 * size.max():
                raise InputError(
                    f"mesh {self.name}: expected a height above zero to scale to {height_m:g} m, "
                    "got a mesh that lies flat; choose the other up axis or give its unit in metres"
                )
            scale = height_m / size[2]
        foot = np.array(((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, low[2]))
        return Stand(y_up, np.zeros(3) if keep_origin else foot, float(scale))

    def standing(
        self, *, y_up: bool, height_m: float | None = None, unit_m: float = 1.0
    ) -> "SurfaceMesh":
        """Return the mesh on its foot, as `stand` and `at` bring it there."""
        return self.at(self.stand(y_up=y_up, height_m=height_m, unit_m=unit_m))

    def at(self, stand: "Stand") -> "SurfaceMesh":
        """Return the mesh as it stands."""
        points = _z_up(self.positions, y_up=stand.y_up)
        return replace(self, positions=(points - stand.foot) * stand.scale)


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """From a file's axes and unit to metres, z up: turned, moved by the foot, then scaled."""

    y_up: bool
    foot: FloatArray
    scale: float


def _z_up(points: FloatArray, *, y_up: bool) -> FloatArray:
    x, y, z = points.T
    return np.stack((x, -z, y) if y_up else (x, y, z), axis=1)


def clean_surface(
    name: str, parts: Sequence[MeshPart], *, texture_bytes: float = 0.0
) -> SurfaceMesh:
    """Join parts into one mesh: equal positions merged, useless triangles and vertices dropped.

    Triangles of zero area and repeats of a triangle with the same winding are dropped; the two
    sides of a sheet are kept.

    Raises `InputError` if an index is out of range, a used vertex is not finite, or no triangle has
    an area.
    """
    vertices, faces = _stack(name, parts)
    used, faces = np.unique(faces, return_inverse=True)
    faces = faces.reshape(-1, 3)
    usable = (np.abs(vertices[used]) <= _FARTHEST).all(axis=1)
    if not usable.all():
        bad = int(used[~usable][0])
        expected = f"expected finite vertices within {_FARTHEST:g}"
        raise InputError(f"mesh {name}: {expected}, got {vertices[bad]} at {bad}")
    uv, corner_uv = _texture_coordinates(name, parts)
    positions, merged = np.unique(vertices[used] + 0.0, axis=0, return_inverse=True)
    corner = merged.ravel().astype(np.int32)[faces]
    keep = _proper(positions, corner)
    if not keep.any():
        raise InputError(f"mesh {name}: expected a triangle with an area, got none")
    left, compact = np.unique(corner[keep], return_inverse=True)
    materials, material_of = np.unique([p.material for p in parts], return_inverse=True)
    part = np.repeat(material_of, [len(p.faces) for p in parts])[keep]
    textured = np.zeros(len(materials), dtype=np.bool_)
    textured[material_of[[p.textured for p in parts]]] = True
    present, part = np.unique(part, return_inverse=True)
    return SurfaceMesh(
        name,
        positions[left],
        compact.reshape(-1, 3).astype(np.int32),
        part.astype(np.int32),
        textured[present],
        uv,
        corner_uv[keep],
        texture_bytes,
        int(len(keep) - keep.sum()),
    )


def _stack(name: str, parts: Sequence[MeshPart]) -> tuple[FloatArray, IntArray]:
    offset, stacked = 0, list[IntArray]()
    for part in parts:
        count = len(part.vertices)
        if len(part.faces) and (part.faces.min() < 0 or part.faces.max() >= count):
            raise InputError(f"mesh {name}: expected indices of {count} vertices, got others")
        stacked.append(part.faces + offset)
        offset += count
    if sum(map(len, stacked)) == 0:
        raise InputError(f"mesh {name}: expected at least one triangle, got none")
    return np.concatenate([p.vertices for p in parts]), np.concatenate(stacked)


def _proper(positions: FloatArray, faces: IntArray) -> BoolArray:
    """Return which faces have an area and do not repeat an earlier face."""
    a, b, c = (positions[faces[:, i]] for i in range(3))
    edges = np.stack((b - a, c - b, a - c))
    longest = np.einsum("efk,efk->ef", edges, edges).max(axis=0)
    double_area = np.linalg.norm(np.cross(edges[0], edges[2]), axis=1)
    # Height over longest edge below 1e-10 is rounding, not shape.
    keep = double_area > 1e-10 * longest
    first = faces.argmin(axis=1)
    turned = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    _, chosen = np.unique(turned, axis=0, return_index=True)
    unique = np.zeros(len(faces), dtype=np.bool_)
    unique[chosen] = True
    return keep & unique


def _texture_coordinates(name: str, parts: Sequence[MeshPart]) -> tuple[FloatArray, IntArray]:
    """Return distinct coordinates and the one of each corner; corners without any share (0, 0)."""
    corners = [
        np.zeros((len(part.faces), 3, 2)) if part.uv is None else part.uv[part.faces]
        for part in parts
    ]
    flat = np.concatenate(corners).reshape(-1, 2)
    require_finite(flat, f"mesh {name}: texture coordinates")
    uv, index = np.unique(flat, axis=0, return_inverse=True)
    return uv, index.reshape(-1, 3).astype(np.int32)
