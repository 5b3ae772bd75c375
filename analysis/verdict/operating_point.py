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

from ...base.arrays import FloatArray
from .keeping import predictive_probability

Scale = Literal["log", "linear"]

SURE = 0.9
"""Probability of keeping another path from which a knob counts as keeping the budget."""

_DIP = 0.02  # fall of ln p99 towards finer that counts: less is noise of the replays
NARROW = 0.05
"""Width of a bracket about an operating point that is narrow enough."""
_WITHIN = 0.98  # of a narrow bracket, so that rounding does not leave one that is not
_POINTS = 33  # at which a crossing is looked for


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
    narrow_enough: float = NARROW,
    near_enough: float = 0.0,
) -> float | None:
    """Return the knob's value to replay next on all paths, or None where all is known well enough.

    It lies in the bracket between the finest knob that keeps the budget and its next finer, of the
    bracket that most training sets wait for: where the crossing would be were ln p99 straight
    there, but a narrow bracket away from the ends, so that a crossing beside an end is closed in.
    That takes half the replays of halving.

    Parameters
    ----------
    values : (K,) float64
        Of the knob, from coarse to fine, its ends included; positive on a log scale.
    p99_ms : (K, n) float64
        On all n paths.
    training : sequence of (t,) int64
        The training sets: indices of paths.
    narrow_enough : float
        Width of a bracket that is left: a ratio less 1 on a log scale, a share of the range on a
        linear one.
    near_enough : float
        Change of ln p99 over a bracket, in the mean over paths, that is left too: where a knob
        hardly moves the work, its value need not be known as well.
    """
    ln_ratio = np.log(p99_ms / budget_ms)
    at = np.log(values) if scale == "log" else values
    narrow = np.log1p(narrow_enough) if scale == "log" else narrow_enough * np.ptp(values)
    waiting: dict[int, list[float]] = {}  # by the index of a bracket's coarse end, crossings in it
    for paths in training:
        sure = np.flatnonzero(keeps_surely(ln_ratio[:, paths]))
        if len(sure) and sure[-1] + 1 < len(at):
            i = int(sure[-1])
            change = abs(float((ln_ratio[i + 1, paths] - ln_ratio[i, paths]).mean()))
            if abs(at[i + 1] - at[i]) > narrow and change > near_enough:
                crossing = _crossing(ln_ratio[i, paths], ln_ratio[i + 1, paths])
                waiting.setdefault(i, []).append(crossing)
    if not waiting:
        return None
    i = max(waiting, key=lambda index: (len(waiting[index]), -index))
    away = min(_WITHIN * narrow / abs(at[i + 1] - at[i]), 0.5)
    part = min(max(float(np.median(waiting[i])), away), 1 - away)
    value = float(at[i] * (1 - part) + at[i + 1] * part)
    return float(np.exp(value)) if scale == "log" else value


def _crossing(coarse: FloatArray, fine: FloatArray) -> float:
    """Return the part of the way, from a knob that keeps to one that does not, where it changes.

    `coarse` and `fine`, (t,), are ln of p99 over budget, interpolated path by path.
    """
    part = np.linspace(0, 1, _POINTS)
    sure = keeps_surely(coarse + part[:, None] * (fine - coarse))
    return float(part[sure][-1]) + 0.5 / (_POINTS - 1)


def keeps_surely(ln_ratio: FloatArray, known_paths: int | None = None) -> NDArray[np.bool_]:
    """Return which knobs, (K,), surely keep the budget, from ln of p99 over budget, (K, n).

    Where only some of the paths are at hand, `known_paths` is how many there are in all.
    """
    if ln_ratio.shape[1] == 1:
        return ln_ratio[:, 0] <= 0
    return predictive_probability(ln_ratio, known_paths) >= SURE
