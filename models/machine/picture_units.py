"""Objects in a picture that is rendered at another size than the window, and what they count."""

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...base.predictors import LEVEL_PREDICTORS
from ..scene.levels import LevelTable
from .cost_terms.catalog import VIEW_TERMS
from .cost_terms.term import Footprint


class InPicture:
    """A footprint in a picture of another size, its arrays (m, 1) where levels stand beside.

    With `at` only of the objects at some positions.
    """

    __slots__ = ("_at", "_seen", "_share")

    def __init__(
        self,
        seen: Footprint,
        pixel_share: float,
        *,
        beside: bool = False,
        at: NDArray[np.intp] | None = None,
    ) -> None:
        self._seen, self._share = seen, pixel_share
        some = slice(None) if at is None else at
        self._at = (some, None) if beside else (some,)

    @property
    def area_px(self) -> FloatArray:
        """Projected areas in the picture."""
        return self._share * self._seen.area_px[self._at]

    @property
    def covered_px(self) -> FloatArray:
        """Samples covered in the picture."""
        return self._share * self._seen.covered_px[self._at]

    @property
    def inside_share(self) -> FloatArray:
        """Shares of the objects that are in the picture."""
        return self._seen.inside_share[self._at]


def view_units(
    predictor: str, levels: LevelTable, row: IntArray, seen: Footprint, pixel_share: float = 1.0
) -> float:
    """Return how many units of a view's term a frame that draws these rows has, whatever it costs.

    Raises KeyError if the predictor is no term of the view.
    """
    term = VIEW_TERMS[predictor]
    level = [levels.counts[row, LEVEL_PREDICTORS.index(name)] for name in term.reads]
    return float(term.count(level, InPicture(seen, pixel_share)).sum())
