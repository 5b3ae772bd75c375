"""Triangles of USD meshes, in the frame of some prim above them.

Pixar, "UsdGeomMesh": polygons with counts of corners, right- or left-handed, holes, and subsets of
faces by material.  Subdivision surfaces are taken as their control meshes, and what moves where it
begins.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ..meshes.surface_mesh import MeshPart

_MOST_CORNERS = 100_000_000


def mesh_parts(prim: Any, transform: FloatArray, materials: dict[str, int]) -> Iterator[MeshPart]:
    """Yield the triangles of a mesh prim, a part for each material.

    Raises `InputError` if counts and indices do not fit.

    Parameters
    ----------
    transform : (4, 4), of column vectors
    materials : numbers by the paths of materials, to which new ones are added
    """
    from pxr import Usd, UsdGeom, UsdShade

    usd: Any = Usd
    geom: Any = UsdGeom
    shade: Any = UsdShade
    time = usd.TimeCode.EarliestTime()  # of what moves, where it begins
    path = str(prim.GetPath())
    mesh: Any = geom.Mesh(prim)
    points = np.array(mesh.GetPointsAttr().Get(time) or (), dtype=np.float64).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(time) or (), dtype=np.int64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get(time) or (), dtype=np.int64)
    if counts.sum() != len(corners) or len(corners) > _MOST_CORNERS or (counts < 0).any():
        raise InputError(f"{path}: expected {counts.sum()} corners of faces, got {len(corners)}")
    if len(corners) and not (corners.min() >= 0 and corners.max() < len(points)):
        raise InputError(f"{path}: expected indices of {len(points)} points, got others")
    faces, owner = _fans(counts, corners)
    holes = np.array(mesh.GetHoleIndicesAttr().Get(time) or (), dtype=np.int64)
    kept = ~np.isin(owner, holes)
    faces, owner = faces[kept], owner[kept]
    left = mesh.GetOrientationAttr().Get() == geom.Tokens.leftHanded
    if left != bool(np.linalg.det(transform[:3, :3]) < 0.0):
        faces = faces[:, ::-1]  # a left hand turns the winding over, and so does a mirror
    placed = points @ transform[:3, :3].T + transform[:3, 3]
    whole = _material(shade, prim)
    of_face = np.full(len(counts), materials.setdefault(whole, len(materials)))
    for subset in shade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        name = _material(shade, subset.GetPrim())
        chosen = np.array(subset.GetIndicesAttr().Get(time) or (), dtype=np.int64)
        if len(chosen) and not (chosen.min() >= 0 and chosen.max() < len(counts)):
            raise InputError(f"{path}: expected faces of a subset, got others")
        of_face[chosen] = materials.setdefault(name, len(materials))
    for number in np.unique(of_face[owner]).tolist():
        yield MeshPart(placed, faces[of_face[owner] == number], number)


def _fans(
    counts: NDArray[np.int64], corners: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return triangles (f, 3) of polygons, as fans about first corners, and whose they are."""
    triangles = np.maximum(counts - 2, 0)
    owner = np.repeat(np.arange(len(counts)), triangles)
    first = (np.cumsum(counts) - counts)[owner]
    nth = np.arange(len(owner)) - np.repeat(np.cumsum(triangles) - triangles, triangles)
    at = np.stack((first, first + nth + 1, first + nth + 2), axis=1)
    return corners[at].reshape(-1, 3), owner


def _material(shade: Any, prim: Any) -> str:
    """Return the path of the material that is bound to a prim, empty where there is none."""
    material, _ = shade.MaterialBindingAPI(prim).ComputeBoundMaterial()
    return str(material.GetPath()) if material else ""
