"""How far an allocation is from the optimum, by the conditions of optimality."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.base.arrays import FloatArray
from lodbench.policies.solvers.allocation import Allocation


@pytest.fixture(scope="session")
def kkt_residual() -> Callable[..., float]:
    """Return a function of an allocation and its problem."""
    return _kkt_residual


def _kkt_residual(
    result: Allocation,
    weight: FloatArray,
    cost: FloatArray,
    budget: float,
    *,
    power: float,
    low: FloatArray | float = 0.0,
    high: FloatArray | float = math.inf,
) -> float:
    """Return the largest relative violation of the optimality conditions; 0 at the optimum.

    Conditions (Karush-Kuhn-Tucker): no bound is broken, the budget is spent or everything is at
    `high`, and value per cost is λ between the bounds, at most λ at `low`, at least λ at `high`.
    """
    x, multiplier = result.x, result.multiplier
    low, high = np.broadcast_to(low, len(x)), np.broadcast_to(high, len(x))
    spent = float(cost @ x)
    outside = float(np.maximum(np.maximum(low - x, x - high), 0.0).max(initial=0.0))
    if multiplier == 0.0:
        # At no price whatever has weight would be taken in full.
        short = bool((x < high)[weight > 0.0].any())
        return max(outside, spent / budget - 1.0, math.inf if short else 0.0)
    ratio = weight * x**-power / (multiplier * cost)
    may_rise = np.where(x < high, ratio - 1.0, 0.0)
    may_fall = np.where(x > low, 1.0 - ratio, 0.0)
    return max(outside, abs(spent / budget - 1.0), float(np.maximum(may_rise, may_fall).max()))
