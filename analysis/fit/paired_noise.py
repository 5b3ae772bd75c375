"""The residual model of a profile, from frames that were drawn twice, apart in time.

What both drawings of a frame have in common is what the model misses of it: in a replay it changes
with the view, as slowly as the path lets it, and is drawn as a slow state.  What differs between
them is the machine's own noise.  One drawing of each frame cannot tell the two apart, and takes the
error of a model for noise that is anew in every frame.

A profile has one relative scale for frames of all lengths, so that frames count by their time: of
very short ones the clock's own steps and interrupts are a larger share.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...models.machine.residual import Residual, ResidualKind
from .rounding import to_digits

_FAR = 6.0  # robust deviations, beyond which a difference is a spike's
_MAD = 1.4826  # deviations of a normal distribution in its median absolute deviation
_MOST_LAGS = 60
_LEAST_DOF, _MOST_DOF = 3.0, 100.0


def pairs_of(path: NDArray[np.int64]) -> NDArray[np.int64] | None:
    """Return rows of both drawings of each frame, (f, 2) in the order of the path, or None.

    Frames that were drawn once are left out; None where those are more than half.
    """
    order = np.argsort(path, kind="stable")
    same = np.flatnonzero(path[order][1:] == path[order][:-1])
    pairs = np.column_stack((order[same], order[same + 1]))
    return pairs if 4 * len(pairs) >= len(path) and len(pairs) > 1 else None


def paired_residual(
    series: Sequence[FloatArray],
    times_ms: Sequence[FloatArray],
    pairs: Sequence[NDArray[np.int64]],
    step_s: float,
    kind: ResidualKind = "student-t",
) -> Residual:
    """Return the residual model of relative residuals in the order of drawing, one series a log.

    Parameters
    ----------
    times_ms
        What the frames took.
    pairs
        As of `pairs_of`, of each log.
    step_s
        Seconds of the path from frame to frame.
    """
    weights = [time[pair].mean(axis=1) for time, pair in zip(times_ms, pairs, strict=True)]
    drawings = [part[pair] for part, pair in zip(series, pairs, strict=True)]
    weight, both = np.concatenate(weights), np.concatenate(drawings)
    apart = (both[:, 0] - both[:, 1]) / np.sqrt(2.0)
    limit = _FAR * _MAD * _weighted_median(np.abs(apart), weight)
    spiked = np.abs(apart) > limit
    quiet = ~spiked
    noise = float(np.average(apart[quiet] ** 2, weights=weight[quiet]))
    missed = float(np.average(both[quiet].prod(axis=1), weights=weight[quiet]))
    slow = np.sqrt(max(missed, 0.0))
    frames = _frames_alike(drawings, weights, missed) if slow else 1.0
    dof = _dof(apart[quiet], weight[quiet], noise) if kind == "student-t" else _MOST_DOF
    # A t of so many degrees of freedom has this much more variance than its scale squared.
    scale = np.sqrt(noise * (dof - 2.0) / dof) if kind == "student-t" else np.sqrt(noise)
    share, excess = _spikes(apart, spiked, weight, limit) if kind == "student-t" else (0.0, 0.0)
    return Residual(
        kind=kind,
        scale=to_digits(float(scale)),
        dof=to_digits(dof),
        floor=float(np.clip(np.floor(10.0 * (1.0 - limit)) / 10.0, 0.0, 1.0)),
        correlation=to_digits(_correlation(series, times_ms, noise)),
        slow_scale=to_digits(min(float(slow), 1.0)),
        slow_time_s=to_digits(max(frames * step_s, 0.01)) if slow else 1.0,
        spike_share=to_digits(share),
        spike_scale=to_digits(excess),
    )


def _weighted_median(values: FloatArray, weight: FloatArray) -> float:
    order = np.argsort(values)
    reached = np.cumsum(weight[order])
    return float(values[order][np.searchsorted(reached, 0.5 * reached[-1])])


def _dof(apart: FloatArray, weight: FloatArray, variance: float) -> float:
    """Return degrees of freedom from the fourth moment, 4 + 6 / excess kurtosis (of differences).

    The difference of two independent errors has half of their excess.
    """
    fourth = float(np.average(apart**4, weights=weight))
    excess = 2.0 * (fourth / variance**2 - 3.0) if variance > 0.0 else 0.0
    dof = 4.0 + 6.0 / excess if excess > 0.0 else _MOST_DOF
    return float(np.clip(dof, _LEAST_DOF, _MOST_DOF))


def _spikes(
    apart: FloatArray, spiked: NDArray[np.bool_], weight: FloatArray, limit: float
) -> tuple[float, float]:
    """Return share of frames with a spike, and its mean as a share of the frame.

    Each pair has two chances.  Spikes are seen from a limit on, beyond which an exponential is as
    it is from nothing on.
    """
    if not spiked.any():
        return 0.0, 0.0
    seen = float(weight[spiked].sum() / weight.sum()) / 2.0
    beyond = np.average(np.abs(apart[spiked]) - limit, weights=weight[spiked])
    scale = max(float(np.sqrt(2.0) * beyond), 1e-3)
    return min(seen * float(np.exp(min(np.sqrt(2.0) * limit / scale, 1.0))), 0.5), scale


def _correlation(
    series: Sequence[FloatArray], times_ms: Sequence[FloatArray], noise: float
) -> float:
    """Return the correlation of the machine's noise from one drawn frame to the next.

    What the model misses is of another frame there, as frames are drawn in shuffled order.
    """
    before = np.concatenate([part[:-1] for part in series])
    after = np.concatenate([part[1:] for part in series])
    weight = np.concatenate([np.minimum(time[:-1], time[1:]) for time in times_ms])
    usual = (np.abs(before) < 1.0) & (np.abs(after) < 1.0)  # no spike
    shared = float(np.average((before * after)[usual], weights=weight[usual]))
    return float(np.clip(shared / noise, 0.0, 0.95)) if noise > 0.0 else 0.0


def _frames_alike(
    drawings: Sequence[FloatArray], weights: Sequence[FloatArray], missed: float
) -> float:
    """Return in how many frames of the path what the model misses falls to 1/e.

    `missed` is its variance; the machine's noise is of other moments in neighbours, and drops out.
    """
    both = [np.clip(part.mean(axis=1), -1.0, 1.0) for part in drawings]
    shortest = min(map(len, both))
    for lag in range(1, min(_MOST_LAGS, shortest // 4)):
        product = np.concatenate([part[:-lag] * part[lag:] for part in both])
        weight = np.concatenate([np.minimum(w[:-lag], w[lag:]) for w in weights])
        if float(np.average(product, weights=weight)) < missed / np.e:
            return float(lag)
    return float(_MOST_LAGS)
