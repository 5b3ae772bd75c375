"""The levels that a model can have: whole collapse steps, and the triangles between two of them.

A policy gives a continuous detail as a real number; the model has a whole number of collapses.  So
two details that lie at one step are the same level, and going from one to the other costs nothing.
"""

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.predictors import LEVEL_PREDICTORS
from ..scene.benefit import level_primitives
from ..scene.levels import LevelTable

BYTES_PER_TRIANGLE = 12.0
"""Of an index set: three indices of four bytes."""

_TRIANGLES = LEVEL_PREDICTORS.index("triangles")
_SPLATS = LEVEL_PREDICTORS.index("splats")
_TRIANGLES_PER_STEP = 2.0  # a half-edge collapse in a closed mesh; two leaves become one


class CollapseSteps:
    """Steps of the types of a level table: 0 is the full model.

    A step takes two triangles off a type of triangles, and one primitive off a type with splats.
    Meshes with borders have steps of one triangle too, which are counted with their neighbours.
    """

    def __init__(self, levels: LevelTable) -> None:
        self._levels = levels
        first = levels.start[:-1]
        width = np.where(levels.counts[first, _SPLATS] > 0.0, 1.0, _TRIANGLES_PER_STEP)
        self._steps = level_primitives(levels)[first] / width

    def level(self, kind: IntArray, detail: FloatArray) -> FloatArray:
        """Return the level of each (type, detail), (m,), a whole number.

        The nearest step of continuous types; of discrete ones the detail itself.
        """
        step = np.rint((1.0 - detail) * self._steps.take(kind))
        return np.where(self._levels.continuous.take(kind), step, detail)

    def resolution(self, kind: IntArray, step: FloatArray) -> FloatArray:
        """Return the resolution that continuous types have after so many steps, (m,)."""
        return 1.0 - step / np.maximum(self._steps.take(kind), 1.0)

    def triangles(self, kind: IntArray, step: FloatArray) -> FloatArray:
        """Return the triangles of continuous types after so many steps, (m,) whole numbers."""
        at = self._levels.position(kind, self.resolution(kind, step))
        return np.rint(self._levels.interpolate(self._levels.counts[:, _TRIANGLES], *at))


def triangles_changed(before: FloatArray, after: FloatArray) -> FloatArray:
    """Return how many triangles differ between index sets of so many triangles, (m,).

    A collapse removes two triangles and moves a corner of four others, as six meet at a vertex of a
    closed mesh on average (Euler).  If it does so anywhere in the mesh, of b triangles that are
    left of a a share (b / a)² was never touched: ``a - b³ / a²`` differ, 6 for a single step.
    Counted on the bundled ordered meshes and foliage it is 0.79 to 1.42 of that, for a few steps
    0.83 to 1 (leaves: two go and one comes, 6 triangles too).  It takes as much to refine again.
    """
    most, least = np.maximum(before, after), np.minimum(before, after)
    touched = least**3 / np.maximum(most, 1.0) ** 2
    return np.rint(most - touched)
