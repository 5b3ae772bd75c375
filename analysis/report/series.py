"""Series short enough to draw: envelopes that keep extremes, and tails."""

from itertools import pairwise

import numpy as np

from ...base.arrays import FloatArray


def envelope(x: FloatArray, y: FloatArray, buckets: int) -> tuple[FloatArray, FloatArray]:
    """Return at most 2 · buckets points of a line, which keep the extremes of every bucket.

    Points whose y is NaN are left out; x increases.
    """
    there = ~np.isnan(y)
    x, y = x[there], y[there]
    if len(x) <= 2 * buckets:
        return x, y
    edges = np.linspace(0, len(x), buckets + 1).astype(np.intp)
    keep: set[int] = set()
    for start, end in pairwise(edges.tolist()):
        keep.add(start + int(np.argmin(y[start:end])))
        keep.add(start + int(np.argmax(y[start:end])))
    at = np.array(sorted(keep))
    return x[at], y[at]


def tail(values: FloatArray, weight: FloatArray, points: int) -> tuple[FloatArray, FloatArray]:
    """Return values in order and the weight of all that is larger or equal, as a share, thinned.

    Every value of the slowest twentieth is kept, since that is where policies differ.
    """
    known = np.flatnonzero(~np.isnan(values) & (weight > 0.0))
    order = known[np.argsort(values[known], kind="stable")]
    n = len(order)
    share = np.cumsum(weight[order][::-1])[::-1]
    share = share / share[:1]
    body = n - max(n // 20, 1)
    at = np.arange(n)
    if n > points:
        at = np.unique(
            np.concatenate((np.linspace(0, body, points).astype(np.intp), np.arange(body, n)))
        )
    return values[order][at], share[at]


def stairs(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the corners of a line of steps, each of which rises or falls before it goes on."""
    return np.repeat(x, 2)[:-1], np.repeat(y, 2)[1:]


def thinned(values: FloatArray, points: int) -> FloatArray:
    """Return so many values at even steps, the first and the last among them; all of few."""
    if len(values) <= points:
        return values
    return values[np.linspace(0, len(values) - 1, points).astype(np.intp)]
