"""Continuous types from foliage."""

import numpy as np

from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from ..meshes.geometry import LevelMesh
from ..meshes.mesh_error import ErrorMeter, Sampling
from ..meshes.type_model import TypeModel
from .foliage import Foliage, Leaves, leaf_triangles


def foliage_type(
    name: str, foliage: Foliage, sampling: Sampling, *, knots: int = 12, least: int = 16
) -> TypeModel:
    """Return the knots of a foliage, geometrically spaced from all leaves to the fewest.

    Raises `InputError` if there are too few or too many knots.

    Parameters
    ----------
    knots : at most; 2 to 256
    least : leaves of the coarsest knot, if the foliage collapses so far
    """
    if not 2 <= knots <= 256:
        raise InputError(f"knots: expected 2 to 256, got {knots}")
    fewest = min(max(least, foliage.full - foliage.steps), foliage.full)
    # Few leaves may round to one count twice: knots are distinct, so there may be fewer.
    wanted = np.geomspace(foliage.full, fewest, knots).round().astype(np.int64)
    levels = [foliage.leaves.at(foliage.extract(int(n))) for n in np.unique(wanted)[::-1]]
    meter = ErrorMeter(*leaf_triangles(levels[0]), sampling)
    errors = [0.0, *(meter.error_m(*leaf_triangles(level)) for level in levels[1:])]
    counts = np.zeros((len(levels), len(LEVEL_PREDICTORS)))
    leaves = np.array([len(level) for level in levels])
    for column, values in (("draw_calls", 1), ("vertices", 4 * leaves), ("triangles", 2 * leaves)):
        counts[:, LEVEL_PREDICTORS.index(column)] = values
    meshes = tuple(_mesh(level) for level in levels)
    # Sampling may find a coarser knot nearer than a finer one; policies count on errors that
    # never fall.
    return TypeModel(name, meshes, counts, np.maximum.accumulate(errors), continuous=True)


def _mesh(leaves: Leaves) -> LevelMesh:
    points, faces = leaf_triangles(leaves)
    normal = np.cross(leaves.along_m, leaves.across_m)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    normals = np.repeat(normal, 4, axis=0).astype(np.float32)
    return LevelMesh(points.astype(np.float32), normals, faces, np.array([0, len(faces)]))
