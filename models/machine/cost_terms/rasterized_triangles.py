"""The GPU predictor ``rasterized_triangles``."""

from collections.abc import Sequence

import numpy as np

from ....base.arrays import FloatArray
from .term import Footprint, ViewTerm


class RasterizedTriangles(ViewTerm):
    """How many of an object's triangles should reach a sample.

    A triangle that covers no sample is dropped after its vertices are transformed, and costs a
    fraction of one that is set up and filled.  If an object's samples fall on its triangles at
    random, of T triangles in the picture ``T · (1 - exp(-samples / T))`` receive one.
    """

    unit = "triangles"
    reads = ("triangles",)

    def count(self, level: Sequence[FloatArray], seen: Footprint) -> FloatArray:
        """Return the expected number of each object, at most all of its triangles."""
        (triangles,) = level
        shown = triangles * seen.inside_share
        samples = seen.covered_px
        per_triangle = np.divide(samples, shown, out=np.zeros(shown.shape), where=shown > 0.0)
        return shown * -np.expm1(-per_triangle)

    def line_above(
        self, full: Sequence[FloatArray], seen: Footprint, lowest: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return a tangent, which touches where a triangle is as large as a sample.

        Their number is concave in the number of triangles, so that every tangent lies above it.
        Triangles go with the resolution, but in a type that has splats too, whose line may lie
        lower.
        """
        triangles = full[0] * seen.inside_share
        samples = seen.covered_px
        at = np.clip(samples / np.maximum(triangles, 1.0), lowest, 1.0)
        share = samples / np.maximum(at * triangles, 1e-9)
        reached = -np.expm1(-share)
        slope = triangles * (reached - share * np.exp(-share))
        return at * (triangles * reached - slope), slope
