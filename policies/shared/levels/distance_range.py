"""Distances between which a level falls from full to coarsest, by the sizes of objects."""

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ....models.scene.scene import Scene

_NEAR_RADII, _FAR_RADII = 4.0, 80.0
"""Where a sphere is 43 % and 2 % of the picture's height across, in a field of view of 60 degrees.

Ours.  Sizes say how far an object matters, and the scene's extent does not: one object alone has an
extent of its own size, and was coarsest from arm's length on.
"""


def distance_range(
    policy: str, scene: Scene, near_m: float | None, far_m: float | None
) -> tuple[FloatArray, FloatArray]:
    """Return the given distances for every node, or for None 4 and 80 of its own radii, (N,).

    Where only one is given, the other is 20 times as far or as near.  Raises `InputError` if they
    are not in order; `policy` is named in the message.
    """
    ratio = _FAR_RADII / _NEAR_RADII
    if near_m is None and far_m is None:
        # A point has no size: it is coarsest from any distance on.
        radius_m = np.maximum(scene.radius_m, 1e-9)
        return _NEAR_RADII * radius_m, _FAR_RADII * radius_m
    near = far_m / ratio if near_m is None and far_m is not None else near_m
    far = near_m * ratio if far_m is None and near_m is not None else far_m
    assert near is not None
    assert far is not None
    if not 0.0 <= near < far:
        raise InputError(f"{policy}: expected 0 <= near_m < far_m, got {near:g} and {far:g}")
    return np.full(len(scene), near), np.full(len(scene), far)
