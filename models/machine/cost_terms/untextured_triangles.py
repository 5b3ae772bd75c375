"""The GPU predictor ``untextured_triangles``."""

from collections.abc import Sequence

import numpy as np

from ....base.arrays import FloatArray
from .term import Footprint, ViewTerm


class UntexturedTriangles(ViewTerm):
    """An object's triangles without a texture, wherever it is in the picture.

    Beside ``textured_triangles`` it lets either kind be the cheaper one; the HLOD thesis measured
    0.127 for a textured triangle and 0.873 for one without (table 6.1).
    """

    unit = "triangles"
    reads = ("triangles", "textured_triangles")

    def count(self, level: Sequence[FloatArray], seen: Footprint) -> FloatArray:
        """Return the number of each object; a level is taken to have no more than finer ones."""
        del seen
        triangles, textured = level
        return np.maximum(triangles - textured, 0.0)
