"""Whether the times of a log are of earlier frames than its counts: a timer read back late.

An engine that reads a GPU query a few frames after it was issued, and writes it into the row of the
frame at hand, pairs each time with the counts of a later frame.  Shifted back, counts explain
times; as they stand, they do not.
"""

from dataclasses import replace

import numpy as np

from ....base.arrays import FloatArray
from ..render_log import RenderLog, TimeName
from .caps import explained

MOST_FRAMES = 6
"""Frames that a timer is looked for to be late by; swap chains and query pools hold fewer."""

_ENOUGH_FRAMES = 60
_GOOD = 0.3  # share of variance that counts must explain once shifted
_BETTER = 0.15  # more than they explain unshifted; chance gives some MOST_FRAMES / n


def frames_late(log: RenderLog, name: TimeName) -> tuple[int, float, float]:
    """Return by how many frames a time is late, and the variance explained so and as it stands.

    0 where nothing says that it is late.
    """
    shares = explained_by_lag(log, name)
    if not shares:
        return 0, 0.0, 0.0
    best = int(np.argmax(shares))
    if shares[best] < max(_GOOD, shares[0] + _BETTER):
        return 0, shares[0], shares[0]
    return best, shares[best], shares[0]


def explained_by_lag(log: RenderLog, name: TimeName) -> tuple[float, ...]:
    """Return the variance of a time that counts of so many rows before explain, of 0 to 6 rows.

    Nothing of a log that is too short, counts nothing, or was not drawn in the order of its rows.
    """
    time_ms, counts = log.time(name), _varying(log.counts)
    if len(log) < _ENOUGH_FRAMES or not counts.size or "drawn_at" in log.recorded:
        return ()
    return tuple(_share(time_ms, counts, lag) for lag in range(MOST_FRAMES + 1))


def _varying(counts: FloatArray) -> FloatArray:
    with np.errstate(over="ignore", invalid="ignore"):
        return counts[:, [np.isfinite(c).any() and np.nanmax(c) > np.nanmin(c) for c in counts.T]]


def _share(time_ms: FloatArray, counts: FloatArray, lag: int) -> float:
    later, earlier = time_ms[lag:], counts[: len(counts) - lag]
    good = (later > 0.0) & (later < 1e9) & (np.abs(earlier) < 1e15).all(axis=1)
    if good.sum() < _ENOUGH_FRAMES // 2:
        return 0.0
    return explained(earlier[good], later[good])


def shifted(log: RenderLog, name: TimeName, lag: int) -> RenderLog:
    """Return the log with a time moved to the frames that it is of; the last ones have none."""
    if lag == 0:
        return log
    time_ms = np.full(len(log), np.nan)
    time_ms[: len(log) - lag] = log.time(name)[lag:]
    note = f"{name} is taken from {lag} {'row' if lag == 1 else 'rows'} further down"
    return replace(log, **{name: time_ms}, notes=(*log.notes, note))
