"""What each stage of Peng's frame costs, fitted to the printed Table 1.

Rendering is a base and so much a triangle.  Selection is a base and so much for each doubling of
the crowd: a sum over all characters, formed in pairs.  Reformation is a base, so much a triangle
and so much a character.  Errors count relative to what is printed, and no coefficient is negative.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from ....base.arrays import FloatArray
from .printed import TABLE_1, Reformation, Row


class Stages(NamedTuple):
    """Coefficients in milliseconds: selection (base, a step), reformation, rendering.

    Those of reformation are base, a triangle and a character; of rendering base and a triangle.
    """

    selection: FloatArray
    reformation: FloatArray
    rendering: FloatArray

    def selection_ms(self, instances: float) -> float:
        """Return what selecting among so many characters takes."""
        base, step = self.selection.tolist()
        return base + step * float(np.log2(instances))

    def reformation_ms(self, instances: float, triangles: float) -> float:
        """Return what reforming so many triangles of so many characters takes."""
        base, a_triangle, a_character = self.reformation.tolist()
        return base + a_triangle * triangles + a_character * instances

    def rendering_ms(self, triangles: float) -> float:
        """Return what drawing so many triangles takes."""
        base, a_triangle = self.rendering.tolist()
        return base + a_triangle * triangles

    def frame_ms(self, instances: float, triangles: float) -> float:
        """Return all three, in series."""
        made = self.reformation_ms(instances, triangles)
        return self.selection_ms(instances) + made + self.rendering_ms(triangles)


def fit_stages(without: int | None = None) -> Stages:
    """Return the stages fitted to Table 1, `without` the row of a number of characters."""
    rows = [row for row in TABLE_1 if row.instances != without]
    instances = np.array([float(row.instances) for row in rows])
    triangles = np.array([float(row.triangles) for row in rows])
    ones = np.ones(len(rows))
    return Stages(
        fit((ones, np.log2(instances)), [row.selection_ms for row in rows]),
        fit_reformation(rows),
        fit((ones, triangles), [row.rendering_ms for row in rows]),
    )


def fit_reformation(
    rows: Sequence[Row] | Sequence[Reformation], *, characters: bool = True
) -> FloatArray:
    """Return base, a triangle's and a character's milliseconds of reformation, (3,).

    The last is 0 unless there is to be a term of `characters`.
    """
    triangles = np.array([float(row.triangles) for row in rows])
    instances = np.array([float(row.instances) for row in rows])
    terms = (np.ones(len(rows)), triangles, instances)
    ms = [row.reformation_ms for row in rows]
    return fit(terms, ms) if characters else np.append(fit(terms[:2], ms), 0.0)


def fit(terms: Sequence[FloatArray], ms: Sequence[float]) -> FloatArray:
    """Return the coefficients, none negative, that leave the least squares of relative errors."""
    relative = np.stack(terms, axis=1) / np.array(ms)[:, None]
    return nnls(relative, np.ones(len(ms)))[0]
