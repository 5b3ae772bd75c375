"""Mean time of frames as a function of coefficients: linear terms and one roofline.

Coefficients are scaled: each is the milliseconds that its column costs where the column has its
mean over the log, so that all are of the size of a frame's time and the base stands beside them.
On a log, the roofline's sides are totals of a frame; the simulator takes the larger side of each
object, which is the same where all objects are bound by the same side, and more otherwise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ...base.errors import InputError
from .fit_frames import Sample
from .terms import Term

BASE = "base"
ROOFLINE = "roofline."

_VARIES = 1e-9  # relative spread, below which a column is constant


@dataclass(frozen=True, slots=True, eq=False)
class Design:
    """Scaled columns of n frames, base first, the roofline's last.

    Attributes
    ----------
    names : names of K coefficients
    unit : (K,) float64
        Mean of each unscaled column: coefficient in ms per unit = scaled coefficient / unit.
    columns : (K, n) float64
    additive : number of columns before the roofline's; K where there is none
    """

    names: tuple[str, ...]
    unit: FloatArray
    columns: FloatArray
    additive: int

    def __len__(self) -> int:
        return self.columns.shape[1]

    @property
    def linear(self) -> bool:
        """Whether there is no roofline."""
        return self.additive == len(self.names)

    def mean(self, scaled: FloatArray) -> FloatArray:
        """Return mean times of W vectors of scaled coefficients, (W, K) to (W, n), ms."""
        k = self.additive
        mean = scaled[:, :k] @ self.columns[:k]
        if not self.linear:
            geometry = scaled[:, k:-1] @ self.columns[k:-1]
            mean += np.maximum(geometry, scaled[:, -1:] * self.columns[-1])
        return mean

    def slopes(self, scaled: FloatArray) -> FloatArray:
        """Return by how much times grow with each of K scaled coefficients, (K,) to (K, n)."""
        if self.linear:
            return self.columns
        k = self.additive
        pixels = scaled[-1] * self.columns[-1] > scaled[k:-1] @ self.columns[k:-1]
        larger = np.vstack([np.broadcast_to(~pixels, self.columns[k:-1].shape), pixels])
        return np.vstack([self.columns[:k], self.columns[k:] * larger])

    def rows(self, which: BoolArray | NDArray[np.int64]) -> "Design":
        """Return the design of some of the frames, in the same units."""
        return Design(
            self.names, self.unit, np.ascontiguousarray(self.columns[:, which]), self.additive
        )


def design_of(sample: Sample, terms: Sequence[Term], unit: FloatArray | None = None) -> Design:
    """Return the design of a sample, in its own units or in those given.

    Raises `InputError` if a column is the same in all frames, so that it cannot be told from the
    base.
    """
    additive: dict[str, FloatArray] = {BASE: np.ones(len(sample))}
    roofline: dict[str, FloatArray] = {}
    for term in terms:
        if term.kind == "roofline":
            roofline = {ROOFLINE + name: sample.column(name) for name in term.predictors}
        else:
            additive[str(term)] = additive_column(sample, term)
    columns = np.stack([*additive.values(), *roofline.values()])
    names = (*additive, *roofline)
    if unit is None:
        unit = _means(names, columns)
    return Design(names, unit, columns / unit[:, np.newaxis], len(additive))


def additive_column(sample: Sample, term: Term) -> FloatArray:
    """Return what a term that is no roofline counts in each frame, (n,)."""
    if term.kind == "knee":
        return np.maximum(sample.column(term.predictors[0]) - term.at, 0.0)
    return np.prod([sample.column(name) for name in term.predictors], axis=0)


def _means(names: Sequence[str], columns: FloatArray) -> FloatArray:
    """Return the mean of each column, base first; raises InputError if another is constant."""
    means: FloatArray = columns.mean(axis=1)
    for name, column, mean in zip(names[1:], columns[1:], means[1:], strict=True):
        if np.ptp(column) <= _VARIES * mean:
            raise InputError(
                f"expected predictors that vary, got {name}, which is {column[0]:g} in all "
                "frames: it cannot be told from the base; leave it out"
            )
    return means
