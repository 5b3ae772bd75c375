"""Order of triangles and vertices for the cache of transformed vertices, as engines import meshes.

Neighbours come to stand close together by the reverse Cuthill-McKee order of the vertex graph
(George and Liu, 1981), here from scipy.  A mesh that a simplifier wrote has no such order, and on
one device types would then differ in cost per triangle for no reason of theirs.
"""

from typing import Any

import numpy as np

from ...base.arrays import IntArray
from ...models.meshes.geometry import LevelMesh


def cache_friendly(mesh: LevelMesh) -> LevelMesh:
    """Return the same triangles in the same parts, in another order."""
    rank = _ranks(mesh)
    corners = np.sort(rank[mesh.faces], axis=1)
    part = np.repeat(np.arange(len(mesh.part_start) - 1), np.diff(mesh.part_start))
    faces = mesh.faces[np.lexsort((corners[:, 2], corners[:, 1], corners[:, 0], part))]
    used, first_use = np.unique(faces, return_index=True)
    order = used[np.argsort(first_use)]
    place = np.zeros(len(mesh.vertices), dtype=np.int32)
    place[order] = np.arange(len(order), dtype=np.int32)
    uv = None if mesh.uv is None else mesh.uv[order]
    return LevelMesh(mesh.vertices[order], mesh.normals[order], place[faces], mesh.part_start, uv)


def _ranks(mesh: LevelMesh) -> IntArray:
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    count = len(mesh.vertices)
    start = mesh.faces.ravel()
    end = mesh.faces[:, (1, 2, 0)].ravel()
    graph: Any = coo_array((np.ones(len(start)), (start, end)), shape=(count, count)).tocsr()
    order: Any = reverse_cuthill_mckee(graph + graph.T, symmetric_mode=True)
    rank = np.empty(count, dtype=np.int32)
    rank[order] = np.arange(count, dtype=np.int32)
    return rank
