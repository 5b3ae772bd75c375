"""The GPU predictor ``reformed_objects``."""

from collections.abc import Sequence

import numpy as np

from ....base.arrays import FloatArray
from .term import Footprint, ViewTerm


class ReformedObjects(ViewTerm):
    """Objects whose level the GPU makes anew in every frame, changed or not: all that are drawn.

    Peng, Park and Cao ("A real-time system of crowd rendering", 2011, section 5.2) pick the
    vertices and triangles of each character, in series with the drawing.
    """

    unit = "objects"

    def count(self, level: Sequence[FloatArray], seen: Footprint) -> FloatArray:
        """Return one of each object."""
        return np.ones_like(seen.area_px)
