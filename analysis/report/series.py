"""Series short enough to draw: envelopes that keep extremes, means of bins, and tails."""

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


def bin_means(x: FloatArray, y: FloatArray, edges: FloatArray) -> FloatArray:
    """Return the mean of y in each bin of x, NaN where a bin is empty."""
    total = np.histogram(x, edges, weights=y)[0]
    count = np.histogram(x, edges)[0]
    return np.divide(total, count, out=np.full(len(total), np.nan), where=count > 0)


def tail(values: FloatArray, points: int) -> tuple[FloatArray, FloatArray]:
    """Return values in order and the share of all that is larger or equal, thinned in its body.

    Every value of the slowest twentieth is kept, since that is where policies differ.
    """
    ordered = np.sort(values[~np.isnan(values)])
    n = len(ordered)
    share = (n - np.arange(n)) / max(n, 1)
    body = n - max(n // 20, 1)
    at = np.arange(n)
    if n > points:
        at = np.unique(
            np.concatenate((np.linspace(0, body, points).astype(np.intp), np.arange(body, n)))
        )
    return ordered[at], share[at]
