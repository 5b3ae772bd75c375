"""The residual model of a profile, from residuals of successive frames.

What frames take beyond their mean has three parts that the simulator draws apart
(`models.machine.residual`): a slow state of the machine, noise that is forgotten within a few
frames, and spikes, which hit single frames and only ever add.  Spikes stand out from their
neighbours; slow state and fast noise are told apart by how the correlation of frames falls with
their distance; and what is left of the fast noise has the tails of Student's t.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ...models.machine.residual import Residual, ResidualKind
from .assessment.spikes import are_spikes, beside_neighbours
from .rounding import to_digits

_MOST = 20_000  # innovations whose tails are looked at
_LAGS = np.array([1, 2, 3, 5, 8, 13, 20, 30, 45, 60])
_SLOW_FRAMES = np.geomspace(10.0, 1_000.0, 25)  # correlation times of a slow state
_FAST = np.linspace(0.0, 0.95, 39)  # correlations from frame to frame
_SLOWER = 5.0  # times the frames in which fast noise is forgotten
_SLOW_SHARE = 0.05  # of the variance, below which a slow state is none
_DOF = (2.1, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0, 20.0, 50.0, 100.0)
_SURE, _RARE = 0.95, 2.5  # of so many logs the largest innovation is at most so many times it
_ONE_SIDED = 3.0  # times as many frames stand out upwards as downwards


@dataclass(frozen=True, slots=True)
class _Parts:
    """Shares of the variance and correlations, of the fast noise and of the slow state."""

    slow_share: float
    slow_frames: float
    correlation: float


def residual_model(
    series: Sequence[FloatArray],
    kind: ResidualKind = "student-t",
    step_s: float = 1.0,
    paths: Sequence[NDArray[np.int64]] | None = None,
) -> Residual:
    """Return the residual model of relative residuals, one series of successive frames a log.

    Parameters
    ----------
    step_s
        Seconds of the path from frame to frame.
    paths
        Places of each log's frames on the path, where they were drawn in another order.  The slow
        state is of the order of drawing.  What the model misses is of the view, so that the fast
        noise is put back into the order of the path, in which a replay will meet it.
    """
    spiked = [are_spikes(part) for part in series] if kind == "student-t" else []
    share, scale, series = _spikes(series, spiked)
    parts = _parts(series)
    variance = float(np.mean(np.concatenate(series) ** 2))
    fast = [_without_slow(part - part.mean(), parts) for part in series]
    own = float(np.concatenate(fast).var())
    # What a smoother takes for the slow state is a part of the fast noise too: given back.
    grown = np.sqrt((1.0 - parts.slow_share) * variance / own) if own > 0.0 else 1.0
    if paths is not None:
        fast = [part[_along(path)] for part, path in zip(fast, paths, strict=True)]
        parts = replace(parts, correlation=float(np.clip(_correlation(fast, 1), 0.0, 0.99)))
    innovation = np.concatenate([_innovations(part * grown, parts.correlation) for part in fast])
    dof, width = _tails(innovation, kind)
    lowest = 1.0 + min(float(part.min()) for part in fast)
    slow = np.sqrt(parts.slow_share * variance)
    return Residual(
        kind=kind,
        scale=to_digits(width),
        dof=to_digits(dof),
        floor=float(np.clip(np.floor(10.0 * lowest) / 10.0, 0.0, 1.0)),
        correlation=to_digits(parts.correlation),
        slow_scale=to_digits(min(float(slow), 1.0)),
        slow_time_s=to_digits(max(parts.slow_frames * step_s, 0.01)) if slow > 0.0 else 1.0,
        spike_share=to_digits(share),
        spike_scale=to_digits(scale),
    )


def _spikes(
    series: Sequence[FloatArray], spiked: Sequence[BoolArray]
) -> tuple[float, float, Sequence[FloatArray]]:
    """Return share and mean of spikes, and the series with neighbours' medians in their place.

    They are seen from a threshold on, beyond which an exponential is as it is from nothing on.
    Where as many frames stand out downwards, the noise has heavy tails and there are none.
    """
    up = int(sum(part.sum() for part in spiked))
    down = int(sum(are_spikes(-part).sum() for part in series)) if up else 0
    if up <= _ONE_SIDED * (down + 1):
        return 0.0, 0.0, series
    clean: list[FloatArray] = []
    excess: list[FloatArray] = []
    least: list[float] = []
    for part, hit in zip(series, spiked, strict=True):
        nearby, limit = beside_neighbours(part)
        excess.append((part - nearby)[hit] / (1.0 + nearby[hit]))
        least.append(limit)
        clean.append(np.where(hit, nearby, part))
    threshold = float(np.mean(least))
    scale = max(float(np.concatenate(excess).mean()) - threshold, 1e-3)
    seen = (up - down) / sum(map(len, series))
    return min(seen * float(np.exp(min(threshold / scale, 1.0))), 0.5), scale, clean


def _parts(series: Sequence[FloatArray]) -> _Parts:
    """Return how residuals' correlation splits, by least squares over lags up to 60 frames."""
    shortest = min(map(len, series))
    lags = _LAGS[shortest // 4 > _LAGS]
    if not len(lags):
        return _Parts(0.0, 1.0, _correlation(series, 1) if shortest > 1 else 0.0)
    seen = np.array([_correlation(series, lag) for lag in lags.tolist()])
    fast = _FAST[:, None] ** lags
    best, found = np.inf, _Parts(0.0, 1.0, 0.0)
    for frames in _SLOW_FRAMES.tolist():
        slow = np.exp(-lags / frames)
        # seen = fast + share · (slow - fast), for each fast correlation
        apart = slow - fast
        share = np.einsum("cl,cl->c", apart, seen - fast) / np.einsum("cl,cl->c", apart, apart)
        share = np.where(np.exp(-_SLOWER / frames) < _FAST, 0.0, np.clip(share, 0.0, 1.0))
        share[share < _SLOW_SHARE] = 0.0
        misses = ((fast + share[:, None] * apart - seen) ** 2).sum(axis=1)
        place = int(np.argmin(misses))
        if misses[place] < 0.98 * best:
            best = float(misses[place])
            found = _Parts(float(share[place]), frames, float(_FAST[place]))
    if found.slow_share == 0.0:
        return _Parts(0.0, 1.0, float(np.clip(_correlation(series, 1), 0.0, 0.99)))
    return found


def _correlation(series: Sequence[FloatArray], lag: int) -> float:
    """Return the correlation of residuals `lag` frames apart; they are about 0."""
    before = np.concatenate([part[:-lag] for part in series])
    after = np.concatenate([part[lag:] for part in series])
    whole = np.concatenate(series)
    squares = float(whole @ whole) / len(whole)
    return float(before @ after) / len(before) / squares if squares > 0.0 else 0.0


def _without_slow(part: FloatArray, parts: _Parts) -> FloatArray:
    """Return residuals without the slow state that is likeliest under normal noise (Wiener)."""
    from scipy.fft import dct, idct

    if parts.slow_share == 0.0:
        return part
    cosine = np.cos(np.pi * np.arange(len(part)) / len(part))
    slow = parts.slow_share * _spectrum(float(np.exp(-1.0 / parts.slow_frames)), cosine)
    fast = (1.0 - parts.slow_share) * _spectrum(parts.correlation, cosine)
    kept: FloatArray = fast / (slow + fast)
    transformed: Any = dct(part, norm="ortho")
    back: Any = idct(kept * np.asarray(transformed, dtype=np.float64), norm="ortho")
    return np.asarray(back, dtype=np.float64)


def _spectrum(correlation: float, cosine: FloatArray) -> FloatArray:
    return (1.0 - correlation**2) / (1.0 - 2.0 * correlation * cosine + correlation**2)


def _innovations(part: FloatArray, correlation: float) -> FloatArray:
    return (part[1:] - correlation * part[:-1]) / np.sqrt(1.0 - correlation**2)


def _along(path: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return frames in the order of the path, all first visits before the second ones."""
    by_place = np.argsort(path, kind="stable")
    ordered = path[by_place]
    visit = np.arange(len(path)) - np.searchsorted(ordered, ordered)
    return by_place[np.argsort(visit, kind="stable")]


def _tails(innovation: FloatArray, kind: ResidualKind) -> tuple[float, float]:
    """Return degrees of freedom and scale by maximum likelihood.

    A t's likelihood is of its core, from which few degrees of freedom promise frames that are far
    longer than any that were seen: there are so many at least that the largest is no rarity.
    """
    from scipy import stats

    deviation = float(np.sqrt(np.mean(innovation**2)))
    if kind != "student-t" or deviation == 0.0:
        return 100.0, deviation
    some = innovation[:: -(-len(innovation) // _MOST)]
    largest = float(np.abs(some).max())
    found: Any = stats.t.fit(some, floc=0.0)
    tried = [min(max(float(found[0]), _DOF[0]), _DOF[-1])]
    tried += [dof for dof in _DOF if dof > tried[0]]
    for dof in tried:
        of_scale: Any = stats.t.fit(some, f0=dof, floc=0.0)
        scale = float(of_scale[2])
        quantile: Any = stats.t.ppf
        worst = float(quantile(0.5 + 0.5 * _SURE ** (1.0 / len(some)), dof))
        if scale * worst <= _RARE * largest:
            return dof, scale
    return _DOF[-1], deviation
