"""The GPU predictor ``shaded_samples``."""

from collections.abc import Sequence

from ....base.arrays import FloatArray
from .term import Footprint, ViewTerm


class ShadedSamples(ViewTerm):
    """Projected area of the bounding sphere in pixels, whatever the level, summed over draws."""

    unit = "px"
    logged_free = True

    def count(self, level: Sequence[FloatArray], seen: Footprint) -> FloatArray:
        """Return the area of each object."""
        return seen.area_px
