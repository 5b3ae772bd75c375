"""Some nodes of a scene, and what is the same of them in every frame, gathered once."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from .scene import Scene


class _PerNode:
    """An array that is computed when first asked for, then kept, read-only.

    `functools.cached_property` takes a lock at that time in Python 3.11, which costs more than
    some of these arrays.
    """

    def __init__(self, compute: Callable[[Any], NDArray[Any]]) -> None:
        self._compute, self._name = compute, compute.__name__
        self.__doc__ = compute.__doc__

    def __get__(self, owner: Any, kind: type) -> Any:
        if owner is None:
            return self
        array = self._compute(owner)
        array.setflags(write=False)
        owner.__dict__[self._name] = array  # found before this descriptor from now on
        return array


if TYPE_CHECKING:
    # What it is to a reader: a protocol of properties, such as `Footprint`, accepts it.
    per_node = property
else:
    per_node = _PerNode


class Lens(NamedTuple):
    """What nodes are in one lens, wherever they are, (m,) each.

    Attributes
    ----------
    radius_m, square_m2 : radius of each bounding sphere, and its square
    disc : ``π f² r²``, pixels at a depth of 1 m
    scale_px : pixels of one metre before scale, at a distance of 1 m
    reach_m : depth up to which a sphere reaches the near plane
    """

    radius_m: FloatArray
    square_m2: FloatArray
    disc: FloatArray
    scale_px: FloatArray
    reach_m: FloatArray


class Nodes:
    """Nodes by their indices; every array is aligned with them and read-only.

    Attributes
    ----------
    scene : Scene
    ids : (m,) integers
    """

    def __init__(self, scene: Scene, ids: IntArray, at: NDArray[np.intp] | None = None) -> None:
        """Take the indices, and the same ones as numpy indexes fastest if they are there."""
        self.scene, self.ids = scene, ids
        if at is not None:
            self.__dict__["at"] = at
        self._lens: tuple[float, float] = (0.0, 0.0)
        self._in_lens: Lens | None = None

    @per_node
    def at(self) -> NDArray[np.intp]:
        """Return the nodes as numpy indexes fastest, (m,)."""
        return self.ids.astype(np.intp)

    def in_lens(self, focal_px: float, near_m: float) -> Lens:
        """Return what does not change while the lens, and its near plane, stay as they are."""
        seen = self._in_lens
        if seen is None or self._lens != (focal_px, near_m):
            self._lens = (focal_px, near_m)
            radius_m = self.radius_m
            square_m2 = radius_m * radius_m
            disc = square_m2 * (math.pi * focal_px**2)
            scale_px = self.scene.scale.take(self.at) * focal_px
            seen = self._in_lens = Lens(radius_m, square_m2, disc, scale_px, radius_m + near_m)
        return seen

    @per_node
    def type_index(self) -> IntArray:
        """Type of each node, (m,) int32."""
        return self.scene.type_index.take(self.at)

    @per_node
    def type_at(self) -> NDArray[np.intp]:
        """Type of each node as numpy indexes fastest, (m,)."""
        return self.type_index.astype(np.intp)

    @per_node
    def radius_m(self) -> FloatArray:
        """Radius of each bounding sphere, (m,)."""
        return self.scene.radius_m.take(self.at)

    @per_node
    def importance(self) -> FloatArray:
        """Return the importance of each node, (m,)."""
        return self.scene.importance.take(self.at)

    @per_node
    def finest_row(self) -> NDArray[np.intp]:
        """Row of the level table of each node's finest level, (m,)."""
        return self.scene.finest_row.take(self.at)

    @per_node
    def coarsest_level(self) -> FloatArray:
        """Index of each node's coarsest level, or knot, (m,) float64."""
        return self.scene.coarsest_level.take(self.at)
