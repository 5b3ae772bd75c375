"""The GPU predictor ``reformed_triangles``."""

from collections.abc import Sequence

import numpy as np

from ....base.arrays import FloatArray
from .term import Footprint, ViewTerm


class ReformedTriangles(ViewTerm):
    """Triangles whose indices the GPU looks up anew in every frame: all that are drawn.

    The "triangle reformation" of Peng, Park and Cao ("A real-time system of crowd rendering", 2011,
    section 5.2), a thread of the GPU each, in series with the drawing.
    """

    unit = "triangles"
    reads = ("triangles",)

    def count(self, level: Sequence[FloatArray], seen: Footprint) -> FloatArray:
        """Return the triangles of each object."""
        (triangles,) = level
        return triangles

    def line_above(
        self, full: Sequence[FloatArray], seen: Footprint, lowest: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the line itself, or one above it in a type that has splats too."""
        (triangles,) = full
        return np.zeros(len(triangles)), triangles
