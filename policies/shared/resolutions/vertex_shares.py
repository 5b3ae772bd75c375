"""Numbers of vertices shared by projected area, as the resolutions at which types have so many."""

from itertools import pairwise

import numpy as np

from ....base.arrays import FloatArray
from ....base.predictors import LEVEL_PREDICTORS
from ....models.scene.levels import LevelTable
from ...selection import Work
from ...solvers.allocation import allocate
from ...view import View

_VERTICES = LEVEL_PREDICTORS.index("vertices")


class VertexShares:
    """Peng's equation 1 in its own unit: ``k_i = N · A_i^(1/α) / Σ A^(1/α)`` vertices each.

    A type has its knots' vertices, and between two of them what lies between, so that a number of
    vertices leads to one of triangles: 10 per cent of the vertices have fewer per cent of those.
    """

    def __init__(self, levels: LevelTable, alpha: float) -> None:
        self._alpha = alpha
        vertices = levels.counts[:, _VERTICES]
        # Coarsest first, as interpolation wants it; of knots that have as many the finest counts.
        starts: list[int] = levels.start.tolist()
        self._knots: list[tuple[FloatArray, FloatArray]] = []
        for first, stop in pairwise(starts):
            rising: FloatArray = np.maximum.accumulate(vertices[first:stop][::-1])
            self._knots.append((rising, levels.resolution[first:stop][::-1]))
        self._least = np.array([of_type[0] for of_type, _ in self._knots])
        self._most = np.array([of_type[-1] for of_type, _ in self._knots])

    def of(self, view: View, total: float, *, filled: bool) -> tuple[FloatArray, Work]:
        """Return the resolution of each candidate, (m,), and the work.

        What a share exceeds a candidate's own vertices by is lost, or `filled` among the others.
        Nobody has fewer than its coarsest level.
        """
        kind = view.type_index
        share, work = self._shares(view, total, filled=filled)
        resolution = np.ones(len(kind))
        numbers: list[int] = np.unique(kind).tolist()
        for number in numbers:
            at = kind == number
            vertices, knots = self._knots[number]
            resolution[at] = np.interp(share[at], vertices, knots)
        return resolution, work

    def _shares(self, view: View, total: float, *, filled: bool) -> tuple[FloatArray, Work]:
        kind, count = view.type_index, len(view)
        if filled:
            low, high = self._least[kind], self._most[kind]
            ones = np.ones(count)
            result = allocate(view.area_px, ones, total, power=self._alpha, low=low, high=high)
            return result.x, Work(count, result.comparisons, result.iterations)
        root = view.area_px ** (1.0 / self._alpha)
        return root * (total / max(float(root.sum()), 1e-300)), Work(count, count, 1)
