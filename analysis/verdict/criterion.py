"""One metric by which policies are put in order, and the margin below which nobody cares."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ..metrics.metric import Better

RELATIVE_MARGIN = 0.1
"""Of the best: differences that decide nothing."""

PICTURE_MARGIN_PX = 0.25
"""Of a screen error: differences that nobody sees."""

POPS_MARGIN_PER_S = 1.0
"""Of visible switches: a second more or less that decides nothing."""

LAG_MARGIN_MS = 3.2
"""Of lag: assumed, a fifth of a refresh at 60 Hz; nobody is known to see less on a screen."""


@dataclass(frozen=True, slots=True, eq=False)
class Criterion:
    """A metric of P policies on n common paths.

    Attributes
    ----------
    name : str
    values : (P, n) float64
    better : "lower" or "higher"
    relative : float
        Margin as a share of the best.
    absolute : float
        Margin in the metric's unit; the larger of both counts.
    """

    name: str
    values: FloatArray
    better: Better = "lower"
    relative: float = RELATIVE_MARGIN
    absolute: float = 0.0

    def turned(self) -> FloatArray:
        """Return the values, (P, n), so turned that less is better."""
        return self.values if self.better == "lower" else -self.values


def beyond_margin(worse: FloatArray, best: FloatArray, criterion: Criterion) -> FloatArray:
    """Return by how much turned values are beyond the margin of the best; 0 or less is within."""
    return worse - best - np.maximum(criterion.relative * np.abs(best), criterion.absolute)
