"""The residual model of a profile, from residuals of successive frames.

The simulator draws the noise of successive frames as an autoregression of order 1 with Student's
t innovations (`models.machine.residual`); the likelihood's noise is that of single frames.  The
correlation and the innovations' tails are therefore fitted to the residuals themselves.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...models.machine.residual import Residual, ResidualKind

_DIGITS = 4
_MOST = 20_000  # innovations whose tails are looked at


def residual_model(series: Sequence[FloatArray], kind: ResidualKind = "student-t") -> Residual:
    """Return the residual model of relative residuals, one series of successive frames a log.

    The correlation is that of lag 1 over all series; degrees of freedom and scale are those of the
    innovations by maximum likelihood; the floor is the lowest factor seen, to a tenth.
    """
    from scipy import stats

    before = np.concatenate([part[:-1] for part in series])
    after = np.concatenate([part[1:] for part in series])
    correlation = float(np.clip((before @ after) / (before @ before), 0.0, 0.99))
    innovation: FloatArray = (after - correlation * before) / np.sqrt(1.0 - correlation**2)
    dof, scale = 100.0, float(np.sqrt(np.mean(innovation**2)))
    if kind == "student-t":
        some = innovation[:: -(-len(innovation) // _MOST)]
        found: Any = stats.t.fit(some, floc=0.0)
        dof, scale = float(found[0]), float(found[2])
    lowest = 1.0 + min(float(part.min()) for part in series)
    return Residual(
        kind=kind,
        scale=_rounded(scale),
        dof=_rounded(min(max(dof, 2.1), 100.0)),
        floor=float(np.clip(np.floor(10.0 * lowest) / 10.0, 0.0, 1.0)),
        correlation=_rounded(correlation),
    )


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
