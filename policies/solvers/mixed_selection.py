"""Discrete increments and smooth variables, raised in turn within one budget.

This work is based on: Zach, Mantler and Karner, "Time-critical rendering of discrete and continuous
levels of detail", VRST 2002, section 3.4.
"""

from typing import Protocol

from .increment_forest import SAME_SLOPE, IncrementForest

_NOTHING = 1e-10  # of the budget: less than this is not worth a step


class Smooth(Protocol):
    """Smooth variables that can be raised."""

    def slope(self) -> float:
        """Return benefit per cost of raising them a little; 0 where nothing can be raised."""
        ...

    def raise_to(self, slope: float, spend: float) -> float:
        """Raise until benefit per cost falls to `slope` or `spend` is spent; return what was."""
        ...


def raise_in_turn(
    discrete: IncrementForest,
    smooth: Smooth,
    budget: float,
    max_steps: int,
    *,
    look_ahead: bool = True,
) -> tuple[float, int]:
    """Raise whichever has the higher benefit per cost until nothing fits; return cost and steps.

    A step is a run of increments better than the smooth variables' slope, or one line search to
    where that slope falls to the increments'; to the next one's, as printed, or with `look_ahead`
    past those that fit in any case.  Whatever step is the last, the budget holds.
    """
    left, steps, exhausted = budget, 0, False
    while left > _NOTHING * budget and steps < max_steps:
        slope_d = discrete.slope(left)
        slope_c = 0.0 if exhausted else smooth.slope()
        if slope_d <= 0.0 and slope_c <= 0.0:
            break
        steps += 1
        # The paper's test is slope_d > slope_c.  A line search ends only near the slope that it
        # aims at, so here equal within rounding is enough; else it would run again for nothing.
        if slope_d >= slope_c * SAME_SLOPE:
            left -= discrete.take(slope_c, left)
        else:
            spent = smooth.raise_to(*(discrete.ahead(left) if look_ahead else (slope_d, left)))
            # From here on only increments can spend anything.
            exhausted = spent <= 0.0
            left -= spent
    return budget - left, steps
