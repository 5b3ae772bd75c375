"""Benefit and degradation of levels of detail: what an optimiser raises or lowers.

Benefit is Funkhouser and Séquin's ``Size · Accuracy · Importance`` (SIGGRAPH 1993, section 4;
formulas as restored in the project's notes) with ``Accuracy = 1 - BaseError / Samples^m``, m = 1
over primitives (flat shading).  With m = 2 every sensible level scores above 0.9999, which tells
policies apart no more; their Focus, Motion and Hysteresis factors were never published and belong
to the policy that uses them, not to the score.

Degradation is Gobbetti and Bouvier's ``importance · w · r^(-m)`` (1999), with m = 1 and w the mean
projected triangle size ``area / full primitives``.
"""

import numpy as np

from ...base.arrays import FloatArray
from ...base.predictors import LEVEL_PREDICTORS
from .levels import LevelTable

BASE_ERROR = 0.5
"""Error of a representation with a single sample (Funkhouser and Séquin)."""

_TRIANGLES = LEVEL_PREDICTORS.index("triangles")
_SPLATS = LEVEL_PREDICTORS.index("splats")


def level_primitives(levels: LevelTable) -> FloatArray:
    """Return triangles plus splats of each level, (L,)."""
    return levels.counts[:, _TRIANGLES] + levels.counts[:, _SPLATS]


def level_accuracy(levels: LevelTable, exponent: float = 1.0) -> FloatArray:
    """Return ``1 - BASE_ERROR / samples^exponent`` of each level, (L,); 0 of an empty level."""
    samples = level_primitives(levels)
    error = np.divide(
        BASE_ERROR, samples**exponent, out=np.ones(len(samples)), where=samples >= 1.0
    )
    return 1.0 - error
