"""The GPU predictor ``triangles_in_view``."""

from collections.abc import Sequence

from ....base.arrays import FloatArray
from .term import Footprint, ViewTerm


class TrianglesInView(ViewTerm):
    """How many of an object's triangles the clipper should let through.

    A triangle outside of the picture is dropped once its vertices are transformed; one inside is
    set up, whether it covers a sample or not.  OpenGL's query of clipping output primitives is the
    measured side of this count (ARB_pipeline_statistics_query).
    """

    unit = "triangles"
    reads = ("triangles",)

    def count(self, level: Sequence[FloatArray], seen: Footprint) -> FloatArray:
        """Return the triangles of each object times the share of it that is in the picture."""
        return level[0] * seen.inside_share

    def line_above(
        self, full: Sequence[FloatArray], seen: Footprint, lowest: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the count at full detail as the slope: triangles go with the resolution.

        But in a type that has splats too, whose line may lie lower.
        """
        del lowest
        slope = full[0] * seen.inside_share
        return 0.0 * slope, slope
