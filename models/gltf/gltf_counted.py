"""Scenes of glTF files whose buffers are not at hand: counts and boxes are in the JSON.

Positions must state their least and greatest values (glTF 2.0, section 3.6.2.5), so that spheres
about objects are known without a vertex.  Errors of coarser levels are not.
"""

from itertools import product

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ..scene.levels import LevelTable
from ..scene.scene import ObjectTypes
from .gltf_counts import count_mesh
from .gltf_objects import Placed, Thing
from .gltf_schema import Document, pick


def counted_types(document: Document, things: list[Thing], axes: FloatArray) -> ObjectTypes:
    """Return types of one level, from counts and boxes alone.

    Raises `InputError` if an object has several levels, whose errors would need the vertices, or a
    mesh states no box.

    Parameters
    ----------
    axes : (3, 3) from glTF's axes to the scene's
    """
    n = len(things)
    counts = np.zeros((n, len(LEVEL_PREDICTORS)))
    center, radius = np.zeros((n, 3)), np.zeros(n)
    for row, thing in enumerate(things):
        if len(thing.levels) > 1:
            raise InputError(
                f"{thing.name}: expected the buffers of an object with levels, got none; put the "
                "files beside the glTF"
            )
        points: list[FloatArray] = []
        for placed in (placed for level in thing.levels for placed in level):
            counts[row] += count_mesh(document, placed.mesh)
            points.append(_corners(document, placed) @ (axes @ thing.transform[:3, :3]).T)
        cloud = np.concatenate(points)
        center[row] = (cloud.min(axis=0) + cloud.max(axis=0)) / 2.0
        radius[row] = max(np.linalg.norm(cloud - center[row], axis=1).max(), 1e-6)
    levels = LevelTable(
        np.arange(n + 1), counts, np.zeros(n), np.zeros(n), np.zeros(n, dtype=np.bool_)
    )
    names = tuple(f"{thing.name or 'object'}-{row}" for row, thing in enumerate(things))
    return ObjectTypes(names, center, radius, levels)


def _corners(document: Document, placed: Placed) -> FloatArray:
    """Return the corners of the boxes of a mesh, placed, (8 k, 3)."""
    found: list[FloatArray] = []
    for part in pick(document.meshes, placed.mesh, "meshes").primitives:
        number = part.attributes.get("POSITION")
        if number is None:
            continue
        accessor = pick(document.accessors, number, "accessors")
        low, high = accessor.min, accessor.max
        if low is None or high is None or len(low) != 3 or len(high) != 3:
            raise InputError(f"accessor {number}: expected min and max of positions, got none")
        if not np.isfinite((*low, *high)).all():
            raise InputError(f"accessor {number}: expected a finite box, got another")
        found.append(np.array(list(product(*zip(low, high, strict=True)))))
    if not found:
        raise InputError("expected a mesh with positions, got none")
    return np.concatenate(found) @ placed.transform[:3, :3].T + placed.transform[:3, 3]
