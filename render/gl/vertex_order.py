"""Order of triangles and vertices for the cache of transformed vertices, as engines import meshes.

By meshoptimizer (Kapoulkine), which follows Forsyth, "Linear-Speed Vertex Cache Optimisation",
2006.  A mesh that a simplifier wrote has no such order, and on one device types would then differ
in cost per triangle for no reason of theirs.  The package is an extra, ``meshopt``, since it is
compiled where it is installed.
"""

from importlib.util import find_spec
from typing import Any

import numpy as np

from ...models.meshes.geometry import LevelMesh


def vertex_order() -> str:
    """Return how meshes are ordered: ``cache``, or without meshoptimizer as in the ``file``."""
    return "file" if find_spec("meshoptimizer") is None else "cache"


def cache_friendly(mesh: LevelMesh) -> LevelMesh:
    """Return the same triangles in the same parts, in another order, unused vertices dropped.

    Without meshoptimizer it is the mesh that was given.
    """
    if vertex_order() == "file":
        return mesh
    import meshoptimizer

    optimizer: Any = meshoptimizer  # its stubs name arrays of nothing
    corners = mesh.faces.astype(np.uint32)
    for begin, end in zip(mesh.part_start[:-1].tolist(), mesh.part_start[1:].tolist(), strict=True):
        part = np.ascontiguousarray(corners[begin:end].ravel())
        ordered = np.empty_like(part)
        optimizer.optimize_vertex_cache(ordered, part, len(part), len(mesh.vertices))
        corners[begin:end] = ordered.reshape(-1, 3)
    place = np.empty(len(mesh.vertices), dtype=np.uint32)
    used = optimizer.optimize_vertex_fetch_remap(place, corners.ravel(), corners.size, len(place))
    order = np.argsort(place)[:used]  # unused vertices have the largest of all places
    uv = None if mesh.uv is None else mesh.uv[order]
    faces = place[corners].astype(np.int32)
    return LevelMesh(mesh.vertices[order], mesh.normals[order], faces, mesh.part_start, uv)
