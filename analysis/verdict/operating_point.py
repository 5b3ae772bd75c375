"""The finest value of a policy's knob at which it surely keeps the budget.

Policies are compared where each spends the same budget in the same way, and not where somebody
left their defaults.  Replays per knob and path are made once: rows are knobs from coarse to fine,
columns are paths, and each training set takes its columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from ...base.arrays import FloatArray
from .keeping import predictive_probability

Scale = Literal["log", "linear"]

SURE = 0.9
"""Probability of keeping another path from which a knob counts as keeping the budget."""

_DIP = 0.02  # fall of ln p99 towards finer that counts: less is noise of the replays
_NARROW = 0.05  # of a bracket: a ratio less 1, or a share of the range
_CLOSE = 0.95  # of that, so that rounding does not leave a bracket just too wide


@dataclass(frozen=True, slots=True)
class OperatingPoint:
    """A knob's value, and what it was chosen for.

    Attributes
    ----------
    index : int
        Of the value among the knobs that were replayed.
    value : float
    probability : float
        That another path of the kind is kept; nan if it was chosen on one path.
    keeps : bool
        False where no knob keeps the budget: then this is the one that misses it least.
    monotone : bool
        Whether finer always took longer.
    """

    index: int
    value: float
    probability: float
    keeps: bool
    monotone: bool


def operating_point(values: FloatArray, p99_ms: FloatArray, budget_ms: float) -> OperatingPoint:
    """Return the finest knob that keeps the budget with probability `SURE`, or the least miss.

    All knobs are looked at, so that a finer one that keeps is found beyond a coarser that does not.
    On a single path, which shows no spread, a knob keeps if that path is kept.

    Parameters
    ----------
    values : (K,) float64
        Of the knob, from coarse to fine.
    p99_ms : (K, n) float64
        Positive; on the n training paths.
    """
    ln_ratio = np.log(p99_ms / budget_ms)
    mean = ln_ratio.mean(axis=1)
    probability = predictive_probability(ln_ratio)
    sure = keeps_surely(ln_ratio)
    index = int(np.flatnonzero(sure)[-1]) if sure.any() else int(mean.argmin())
    return OperatingPoint(
        index=index,
        value=float(values[index]),
        probability=float(probability[index]),
        keeps=bool(sure.any()),
        monotone=bool((np.diff(mean) >= -_DIP).all()),
    )


def next_knob(
    values: FloatArray,
    p99_ms: FloatArray,
    budget_ms: float,
    scale: Scale,
    training: Sequence[NDArray[np.int64]],
) -> float | None:
    """Return the knob's value to replay next on all paths, or None where all is known well enough.

    It lies in the bracket between the finest knob that keeps the budget and its next finer: in the
    bracket that most training sets wait for, and of these the coarsest.  There it is where the
    bound that must be within the budget would reach it, were it straight between (regula falsi);
    close to an end, it is where a bracket from that end would be narrow enough: within 5 % of its
    value on a log scale, of the range on a linear one.

    Parameters
    ----------
    values : (K,) float64
        Of the knob, from coarse to fine, its ends included; positive on a log scale.
    p99_ms : (K, n) float64
        On all n paths.
    training : sequence of (t,) int64
        The training sets: indices of paths.
    """
    ln_ratio = np.log(p99_ms / budget_ms)
    at = np.log(values) if scale == "log" else values
    narrow = np.log1p(_NARROW) if scale == "log" else _NARROW * np.ptp(values)
    waiting: dict[int, list[float]] = {}
    for paths in training:
        of_set = ln_ratio[:, paths]
        sure = np.flatnonzero(keeps_surely(of_set))
        if len(sure) and sure[-1] + 1 < len(at):
            i = int(sure[-1])
            if abs(at[i + 1] - at[i]) > narrow:
                kept, beyond = _bound(of_set[i]), _bound(of_set[i + 1])
                waiting.setdefault(i, []).append(_crossing(kept, beyond))
    if not waiting:
        return None
    i = max(waiting, key=lambda index: (len(waiting[index]), -index))
    width = abs(at[i + 1] - at[i])
    nearest = min(_CLOSE * narrow / width, 0.5)
    share = float(np.clip(np.median(waiting[i]), nearest, 1.0 - nearest))
    next_at = float(at[i] + share * (at[i + 1] - at[i]))
    return float(np.exp(next_at)) if scale == "log" else next_at


def _bound(ln_ratio: FloatArray) -> float:
    """Return what ln of p99 over budget on another path is surely below, from those of t paths."""
    n = len(ln_ratio)
    if n == 1:
        return float(ln_ratio[0])
    reach = float(stdtrit(n - 1, SURE)) * np.sqrt(1 + 1 / n)
    return float(ln_ratio.mean() + reach * ln_ratio.std(ddof=1))


def _crossing(kept: float, beyond: float) -> float:
    """Return where between two bounds, at most 0 and above, a line through them is 0."""
    return 0.5 if not np.isfinite(beyond - kept) or beyond <= kept else -kept / (beyond - kept)


def keeps_surely(ln_ratio: FloatArray) -> NDArray[np.bool_]:
    """Return which knobs, (K,), surely keep the budget, from ln of p99 over budget, (K, n)."""
    if ln_ratio.shape[1] == 1:
        return ln_ratio[:, 0] <= 0
    return predictive_probability(ln_ratio) >= SURE
