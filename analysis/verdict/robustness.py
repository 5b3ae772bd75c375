"""How far the first rank stands: at other speeds, other refresh rates, and with other costs.

Nothing is replayed: a machine of speed f does the work of the curve in 1/f of the time, so that
its operating point is the one for f times the budget.  That is exact for costs which all scale
alike, and for policies that decide by the picture; for controllers it takes their aim as the
scene's own scale.  Costs that nobody measured are added to runs as they were (see `added_costs`).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray
from .criterion import PICTURE_MARGIN_PX, POPS_MARGIN_PER_S, RELATIVE_MARGIN, Criterion
from .curve import LEAST_ERROR_PX, Curve
from .operating_point import keeps_surely
from .ranking import ranking

REFRESH_HZ = (30.0, 60.0, 90.0, 120.0)
SLOWEST, FASTEST = 0.5, 2.0
_STEPS = 12  # of speed, to either end
_BETWEEN = 64  # points for each value of a knob that was replayed


@dataclass(frozen=True, slots=True)
class Robustness:
    """Over which conditions the first rank stands.

    Attributes
    ----------
    first : tuple of str
        The policies of the first rank at the budget, the leader first; empty if nobody keeps it.
    speed_low, speed_high : float or None
        The stretch of machine speed about 1 over which that leader stays in the first rank, within
        0.5 to 2; None if nobody keeps the budget.
    at_refresh : mapping of float to tuple of str
        The policies of the first rank, the leader first, when a refresh at so many Hz is the
        budget; empty if nobody keeps it.
    misses : mapping of float to tuple of str
        By Hz, who does not reach that budget with the coarsest value of its knob.
    with_costs : mapping of str to tuple of str
        As `at_refresh`, with each cost that nobody measured, by its name, at the budget.
    misses_with : mapping of str to tuple of str
        By such a cost, who does not reach the budget.
    """

    first: tuple[str, ...]
    speed_low: float | None
    speed_high: float | None
    at_refresh: Mapping[float, tuple[str, ...]]
    misses: Mapping[float, tuple[str, ...]]
    with_costs: Mapping[str, tuple[str, ...]]
    misses_with: Mapping[str, tuple[str, ...]]


def robustness(
    curves: Mapping[str, Curve],
    budget_ms: float,
    relative: float = RELATIVE_MARGIN,
    known_paths: int | None = None,
) -> Robustness:
    """Return over which speeds and refresh rates the first rank at the budget stands.

    Parameters
    ----------
    curves : mapping of label to Curve
        Of the policies, all on the same n paths.
    relative : float
        Margin as a share of the best.
    known_paths : int or None
        Number of paths on which operating points were chosen, where curves are of fewer: how they
        spread is then taken from the curves, and how much is known of it from that number.
    """
    fine = {label: _Fine.of(curve, known_paths) for label, curve in curves.items()}
    points = {label: of.at(budget_ms) for label, of in fine.items()}
    first = _first(points, relative)
    refresh = {hz: {label: of.at(1e3 / hz) for label, of in fine.items()} for hz in REFRESH_HZ}
    costlier = {
        cost: {
            label: _Fine.of(replace(curve, p99_ms=curve.added_ms[cost]), known_paths).at(budget_ms)
            for label, curve in curves.items()
        }
        for cost in _common_costs(curves)
    }
    low = high = None
    if first:

        def stands(speed: float) -> bool:
            there = {label: of.at(budget_ms * speed) for label, of in fine.items()}
            return first[0] in _first(there, relative)

        steps = np.arange(1, _STEPS + 1) / _STEPS
        low = _furthest(SLOWEST**steps, stands)
        high = _furthest(FASTEST**steps, stands)
    return Robustness(
        first=first,
        speed_low=low,
        speed_high=high,
        at_refresh={hz: _first(there, relative) for hz, there in refresh.items()},
        misses={
            hz: tuple(label for label, point in there.items() if point is None)
            for hz, there in refresh.items()
        },
        with_costs={cost: _first(there, relative) for cost, there in costlier.items()},
        misses_with={
            cost: tuple(label for label, point in there.items() if point is None)
            for cost, there in costlier.items()
        },
    )


def _common_costs(curves: Mapping[str, Curve]) -> list[str]:
    """Return the added costs that all curves know."""
    if not curves:
        return []
    first, *others = curves.values()
    return [cost for cost in first.added_ms if all(cost in of.added_ms for of in others)]


@dataclass(frozen=True, slots=True, eq=False)
class _Fine:
    """A curve with points between the knob's values, interpolated path by path along the knob.

    Attributes
    ----------
    ln_p99 : (F, n) float64
    seen : (3, F, n) float64
        Visible error, visible pops, mean work.
    known_paths : int or None
        On so many paths its spread is known; None for n.
    """

    ln_p99: FloatArray
    seen: FloatArray
    known_paths: int | None

    @classmethod
    def of(cls, curve: Curve, known_paths: int | None) -> "_Fine":
        """Return the curve with `_BETWEEN` points for each that it has."""
        k = len(curve.knob)
        at = np.linspace(0, k - 1, _BETWEEN * (k - 1) + 1)
        left = np.minimum(at.astype(np.int64), max(k - 2, 0))
        right, part = np.minimum(left + 1, k - 1), (at - left)[:, None]

        def between(table: FloatArray) -> FloatArray:
            return table[left] * (1 - part) + table[right] * part

        # Work and errors change by factors along a knob: straight between them would be too large.
        error_px = np.exp(between(np.log(np.maximum(curve.error_px, LEAST_ERROR_PX))))
        work_ms = np.exp(between(np.log(curve.work_ms)))
        seen = np.array([error_px, between(curve.pops_per_s), work_ms])
        return cls(between(np.log(curve.p99_ms)), seen, known_paths)

    def at(self, budget_ms: float) -> FloatArray | None:
        """Return what is seen at the finest point that keeps the budget, (3, n), if any does."""
        beyond = self.ln_p99 - np.log(budget_ms)
        kept = np.flatnonzero(keeps_surely(beyond, self.known_paths))
        return self.seen[:, kept[-1]] if len(kept) else None


def _first(points: Mapping[str, FloatArray | None], relative: float) -> tuple[str, ...]:
    """Return the policies of the first rank among those that keep the budget, leader first."""
    kept = {label: point for label, point in points.items() if point is not None}
    if not kept:
        return ()
    seen = np.stack(list(kept.values()), axis=1)
    error, pops, work = seen
    order = (
        Criterion("visible_error_px", error, relative=relative, absolute=PICTURE_MARGIN_PX),
        Criterion("visible_pops_per_s", pops, relative=relative, absolute=POPS_MARGIN_PER_S),
        Criterion("work_ms_mean", work, relative=relative),
    )
    return ranking(list(kept), order)[0].members


def _furthest(speeds: FloatArray, stands: Callable[[float], bool]) -> float:
    """Return the last of the speeds, from 1 away, up to which it stands at each."""
    reached = 1.0
    for speed in speeds.tolist():
        if not stands(speed):
            break
        reached = speed
    return reached
