"""Whether frame intervals are tied to a refresh or a limiter, and so carry no cost.

Three signs, each over several periods and each with a control, since intervals of an honest
renderer that happens to run near a refresh look like those of a capped one:

- **quantised**: intervals lie at two or more different multiples of a refresh, and hardly between;
- **locked**: the moments of presenting keep their phase in the refresh (Rayleigh's test), which the
  same intervals in another order do not;
- **constant**: intervals lie at one refresh, and neither busy times nor what was drawn explain
  their spread.
"""

from math import ceil
from typing import Any

import numpy as np

from ....base.arrays import FloatArray

# Refresh rates of displays in use, and half of them, at which frames that take two refreshes come.
REFRESH_HZ = (24, 25, 30, 36, 40, 45, 48, 50, 60, 72, 75, 80, 90, 100, 120, 144, 165, 240, 360)

_ENOUGH_FRAMES = 30  # below, nothing can be said of a distribution
_SLOWEST_MS = 1e4  # longer is a pause, not a frame
_CLUSTERED = 0.8  # share of frames within 3 % of a refresh of whole refreshes
_NEAR = 0.03
_SECOND = 0.02  # share of frames at another multiple than most
_LOCKED = 0.5  # resultant length of presents' phases in the refresh; noise alone gives n^(-1/2)
_CONTROL = 0.7  # part of it that the intervals in other orders may keep
_LOCKED_FRAMES, _LOCKED_PERIODS = 200, 50
_LONGEST = 2_000  # frames; longer, and the refresh would have to be known to a part in 10,000
_MOST_STEPS = 2_000
_SPAN = 0.005  # of a nominal rate, within which real ones lie
_CONSTANT = 0.01  # spread of intervals at one refresh
_EXPLAINED = 0.3  # share of variance, from which intervals follow the load


def capped_at_hz(time_ms: FloatArray, load: FloatArray | None = None) -> float | None:
    """Return the rate that frame intervals are tied to, or None.

    Parameters
    ----------
    load
        (n, k) busy times and counts of the same frames, as the control; NaN where there is none.
    """
    good = np.isfinite(time_ms) & (time_ms > 0.0) & (time_ms < _SLOWEST_MS)
    time_ms = time_ms[good]
    if len(time_ms) < _ENOUGH_FRAMES:
        return None
    for rate in REFRESH_HZ:
        refreshes: FloatArray = time_ms * (rate / 1e3)
        whole: FloatArray = np.maximum(np.rint(refreshes), 1.0)
        if np.mean(np.abs(refreshes - whole) < _NEAR) < _CLUSTERED:
            continue
        _, counts = np.unique(whole, return_counts=True)
        if len(counts) > 1 and np.sort(counts)[-2] >= max(3, _SECOND * len(whole)):
            return float(rate)
        if _is_constant(time_ms, None if load is None else load[good]):
            return float(rate)
    return _locked(time_ms)


def _is_constant(time_ms: FloatArray, load: FloatArray | None) -> bool:
    middle = float(np.median(time_ms))
    spread = 1.4826 * float(np.median(np.abs(time_ms - middle)))
    return spread < _CONSTANT * middle and not _follows(time_ms, load)


def _follows(time_ms: FloatArray, load: FloatArray | None) -> bool:
    """Return whether load explains intervals: at least one frame in three of their variance."""
    if load is None or not load.size:
        return False
    known = np.isfinite(load).all(axis=1)
    if known.sum() < _ENOUGH_FRAMES:
        return False
    return explained(load[known], time_ms[known]) > _EXPLAINED


def explained(load: FloatArray, time_ms: FloatArray) -> float:
    """Return the share of variance of times, (n,), that loads, (n, k), explain by least squares.

    Times beyond the middle 98 % count as its ends: a hitch is not to decide.
    """
    time_ms = np.clip(time_ms, *np.quantile(time_ms, (0.01, 0.99)))
    away = load - load.mean(axis=0)
    size = np.abs(away).max(axis=0)
    away = away[:, size > 0.0] / size[size > 0.0]
    centred = time_ms - time_ms.mean()
    total = float(centred @ centred)
    if total <= 0.0 or not away.size:
        return 0.0
    solve: Any = np.linalg.lstsq
    rest: FloatArray = centred - away @ solve(away, centred, rcond=1e-9)[0]
    degrees = max(len(time_ms) - 1 - away.shape[1], 1)
    return 1.0 - float(rest @ rest) / degrees / (total / (len(time_ms) - 1))


def _locked(time_ms: FloatArray) -> float | None:
    time_ms = time_ms[-_LONGEST:]
    if len(time_ms) < _LOCKED_FRAMES:
        return None
    # Each frame takes a refresh at least; of more than four, phases say nothing of it.
    middle_s = float(np.median(time_ms)) / 1e3
    for rate in REFRESH_HZ:
        if not (0.9 <= middle_s * rate <= 4.5):
            continue
        if time_ms.sum() / 1e3 * rate < _LOCKED_PERIODS:
            continue
        length, hz = _resultant(time_ms, rate)
        if length < _LOCKED:
            continue
        rng = np.random.default_rng(0)
        others = [_resultant(rng.permutation(time_ms), rate)[0] for _ in range(5)]
        if max(others) < _CONTROL * length:
            return hz
    return None


def _resultant(time_ms: FloatArray, rate: float) -> tuple[float, float]:
    """Return the longest resultant of presents' phases at rates near one, and that rate.

    The steps are a quarter of what n periods can tell apart.  From one rate to the next, each phase
    turns by the same angle, so that two multiplications stand for a cosine and a sine.
    """
    presented_s = np.cumsum(time_ms) / 1e3
    low = rate * (1.0 - _SPAN)
    steps = min(ceil(8.0 * _SPAN * rate * float(presented_s[-1])), _MOST_STEPS) + 3
    rates = np.linspace(low, rate * (1.0 + _SPAN), steps)
    turn = np.exp(2j * np.pi * low * presented_s)
    step = np.exp(2j * np.pi * float(rates[1] - rates[0]) * presented_s)
    best, best_hz = 0.0, rate
    for hz in rates.tolist():
        length = abs(complex(turn.sum())) / len(turn)
        if length > best:
            best, best_hz = length, hz
        turn *= step
    return best, best_hz
