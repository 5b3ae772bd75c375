"""What a policy makes of any budget: picture, pops and lag over its knob, and two such compared."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from scipy.interpolate import PchipInterpolator

from ...base.arrays import FloatArray
from .intervals import Interval, such_paths

Quantity = Literal["p99_ms", "work_ms", "error_px", "pops_per_s", "lag_ms"]

LEAST_ERROR_PX = 0.01
"""An error below this is taken as this, where its logarithm counts: it would decide alone."""


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One policy on n paths at K values of its knob, over the knob's whole range.

    Attributes
    ----------
    knob : (K,) float64
        From coarse to fine; a policy without a knob has one value.
    p99_ms, work_ms : (K, n) float64
        The p99 over time of the work, which budgets judge, and its mean.
    error_px, pops_per_s, lag_ms : (K, n) float64
        Visible error, visible pops, mean lag.
    added_ms : mapping of str to (K, n) float64
        As `p99_ms`, with each cost that nobody measured, by its name.
    """

    knob: FloatArray
    p99_ms: FloatArray
    work_ms: FloatArray
    error_px: FloatArray
    pops_per_s: FloatArray
    lag_ms: FloatArray
    added_ms: Mapping[str, FloatArray] = field(default_factory=dict[str, FloatArray])

    def interval(self, quantity: Quantity, level: float = 0.9) -> tuple[Interval, ...]:
        """Return the interval of a quantity over such paths at each of the K values."""
        rows: FloatArray = getattr(self, quantity)
        found = tuple(such_paths(of, "positive", level) for of in rows)
        return tuple(of for of in found if of is not None)


def area_between(curve_a: Curve, curve_b: Curve) -> float | None:
    """Return by how many per cent the error of b is larger than that of a at equal work.

    The mean over the range of p99 work that both curves reach, on logarithmic scales; None where
    they have no such range.  Negative: b draws the finer picture.

    Source: Bjøntegaard, VCEG-M33 (2001), with piecewise cubic Hermite interpolation as in
    VCEG-AL22 (2009).
    """
    a, b = _ln_error_over_ln_work(curve_a), _ln_error_over_ln_work(curve_b)
    if a is None or b is None:
        return None
    low, high = max(a.x[0], b.x[0]), min(a.x[-1], b.x[-1])
    if low >= high:
        return None
    mean = (b.integrate(low, high) - a.integrate(low, high)) / (high - low)
    return 100.0 * float(np.expm1(mean))


def _ln_error_over_ln_work(curve: Curve) -> PchipInterpolator | None:
    """Return the curve of means over paths, or None if it has fewer than two points of work.

    Of points with equal work the finest picture counts.
    """
    work = np.log(curve.p99_ms).mean(axis=1)
    error = np.log(np.maximum(curve.error_px, LEAST_ERROR_PX)).mean(axis=1)
    order = np.lexsort((error, work))
    x, first = np.unique(work[order], return_index=True)
    return PchipInterpolator(x, error[order][first]) if len(x) > 1 else None
