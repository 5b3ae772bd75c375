"""Which columns of a design cannot be told apart, and what of them can be.

Belsley, Kuh, Welsch, "Regression diagnostics", 1980, chapter 3: condition indices of columns of
unit length, and shares of each coefficient's variance.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ....base.arrays import FloatArray
from ..design import Design

_STRONG = 30.0  # condition index, above which Belsley et al. speak of strong dependence
_SHARE = 0.5  # of a coefficient's variance


@dataclass(frozen=True, slots=True, eq=False)
class Collinear:
    """Columns that go together.

    Attributes
    ----------
    names : the columns, the one that costs most first
    ratio : (len(names),) float64
        How many of each come with one of the first, on average; the combination
        ``Σ ratio · coefficient`` is what the log informs.
    condition_index : of the direction in which they differ
    """

    names: tuple[str, ...]
    ratio: FloatArray
    condition_index: float

    @property
    def combination(self) -> str:
        """The informed combination in words, such as ``vertices + 0.58 triangles``."""
        rest = zip(self.ratio[1:], self.names[1:], strict=True)
        return " + ".join([self.names[0], *(f"{ratio:.3g} {name}" for ratio, name in rest)])


@dataclass(frozen=True, slots=True, eq=False)
class Collinearity:
    """Condition number of the scaled design, and the columns at fault if it is high."""

    condition_number: float
    groups: tuple[Collinear, ...]


def examine(design: Design, scaled: Sequence[float] | FloatArray) -> Collinearity:
    """Return the collinearity of a design; `scaled` coefficients say which columns cost most."""
    columns = design.columns.T
    lengths = np.sqrt(np.einsum("nk,nk->k", columns, columns))
    _, values, right = np.linalg.svd(columns / lengths, full_matrices=False)
    values = np.maximum(values, 1e-12 * values[0])
    shares = (right / values[:, np.newaxis]) ** 2
    shares /= shares.sum(axis=0)
    groups: list[Collinear] = []
    for share, index in zip(shares, values[0] / values, strict=True):
        members = np.flatnonzero(share > _SHARE)
        if index > _STRONG and len(members) > 1:
            groups.append(_group(design, members[np.argsort(-np.asarray(scaled)[members])], index))
    return Collinearity(float(values[0] / values[-1]), tuple(groups))


def _group(design: Design, members: NDArray[np.intp], index: float) -> Collinear:
    raw: FloatArray = design.columns[members] * design.unit[members, np.newaxis]
    return Collinear(
        tuple(np.array(design.names)[members].tolist()),
        raw @ raw[0] / (raw[0] @ raw[0]),
        float(index),
    )
