"""How two captures differ, each difference with an interval.

Successive frames are alike, so that the interval cannot come from the spread of single frames.
Each capture is cut into blocks of successive frames, which are drawn with replacement until there
are as many frames again (the circular block bootstrap of Politis and Romano, 1992); of 500 such
pairs of captures, the middle 95 % of the differences are the interval, widened as Student's t is
for as few blocks as there are.  A block is some two seconds long, or a tenth of a short capture:
longer than what makes neighbours alike, such as a hitch and its aftermath.

It covers another capture of the same scene on the same machine in the same state.  What changes
between runs of a game, no single pair of captures can tell.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...traces.logs.render_log import RenderLog
from .capture_frames import AVERAGE_FPS, METRICS, intervals_of, score

SCHEMA = "lodbench.log-compare/2"
METHOD = "circular block bootstrap, 500 draws, widened for few blocks, 95 %"

DRAWS = 500
_LEVEL = 0.95
_BLOCK_MS = 2_000.0
_FEWEST_BLOCKS = 10
_FEWEST_FRAMES = 30
_MOST_FRAMES = 20_000  # of a draw: longer captures are drawn from whole, in fewer blocks
_DIGITS = 6


@np.errstate(all="ignore")  # as `capture_record`
def compare_captures(first: RenderLog, second: RenderLog, seed: int = 0) -> dict[str, Any]:
    """Return the differences of two captures, second minus first, as JSON.

    Raises `InputError` if one has no frame times, or fewer than 30 frames.
    """
    logs = (first, second)
    series = _series(first, second)
    frames = [intervals_of(log)[series] for log in logs]
    rng = np.random.default_rng(seed)
    scores = [score(values) for values in frames]
    draws = [_drawn(values, score, rng) for values in frames]
    blocks = [int(np.ceil(len(values) / block_frames(values))) for values in frames]
    wider = _widening(min(blocks))
    metrics = {
        name: _difference(
            [scores[0][name], scores[1][name]], [draws[0][name], draws[1][name]], wider
        )
        for name in (AVERAGE_FPS, *METRICS)
        if name != "frame_ms_max"  # an extreme has no interval
    }
    for name in ("gpu_ms", "cpu_ms"):
        times = [getattr(log, name) for log in logs]
        if all(time is not None and (time > 0.0).sum() >= _FEWEST_FRAMES for time in times):
            good = [time[time > 0.0] for time in times]
            drawn = [_drawn(time, _mean, rng) for time in good]
            metrics[f"{name}_mean"] = _difference(
                [float(time.mean()) for time in good], [draw["mean"] for draw in drawn], wider
            )
    return {
        "schema": SCHEMA,
        "logs": [log.name for log in logs],
        "series": series,
        "frames": [len(values) for values in frames],
        "blocks": blocks,
        "method": METHOD,
        "level": _LEVEL,
        "seed": seed,
        "metrics": metrics,
    }


def _mean(values: FloatArray) -> dict[str, float | None]:
    return {"mean": float(values.mean())}


def _series(first: RenderLog, second: RenderLog) -> str:
    """Return the series that both have: from frame to frame if possible, else between displays."""
    have = [intervals_of(log) for log in (first, second)]
    for name in ("frames", "displays"):
        if all(name in held for held in have):
            short = min(
                (len(held[name]), log.name) for held, log in zip(have, (first, second), strict=True)
            )
            if short[0] < _FEWEST_FRAMES:
                message = f"expected {_FEWEST_FRAMES} frames or more, got {short[0]}"
                raise InputError(f"{short[1]}: {message}; record longer")
            return name
    lacking = first if not have[0] else second
    raise InputError(
        f"{lacking.name}: expected times from frame to frame, got a log without; record them"
    )


def block_frames(interval_ms: FloatArray) -> int:
    """Return how many successive frames a block has: some two seconds, ten blocks at least."""
    two_seconds = int(np.ceil(_BLOCK_MS / float(interval_ms.mean())))
    return max(1, min(two_seconds, len(interval_ms) // _FEWEST_BLOCKS))


def _drawn(
    values: FloatArray,
    statistic: Callable[[FloatArray], Mapping[str, float | None]],
    rng: np.random.Generator,
) -> dict[str, FloatArray]:
    """Return each statistic of `DRAWS` captures drawn from one; NaN where it has none."""
    length, count = block_frames(values), len(values)
    wrapped = np.concatenate((values, values[: length - 1]))
    size = min(count, _MOST_FRAMES)
    blocks = int(np.ceil(size / length))
    inflate = np.sqrt(size / count)  # what a shorter draw exaggerates
    rows: list[dict[str, float]] = []
    for _ in range(DRAWS):
        starts = rng.integers(0, count, blocks)
        drawn = wrapped[(starts[:, np.newaxis] + np.arange(length)).ravel()[:size]]
        rows.append({name: np.nan if v is None else v for name, v in statistic(drawn).items()})
    table = {name: np.array([row[name] for row in rows]) for name in rows[0]}
    return {
        name: np.median(column) + (column - np.median(column)) * inflate
        for name, column in table.items()
    }


def _widening(blocks: int) -> float:
    """Return what an interval of so few blocks lacks: of Student's t, and of their variance."""
    from scipy.stats import norm, t

    tail = 0.5 * (1.0 + _LEVEL)
    return float(t.ppf(tail, blocks - 1) / norm.ppf(tail)) * float(np.sqrt(blocks / (blocks - 1)))


def _difference(
    values: list[float | None], draws: list[FloatArray], wider: float
) -> dict[str, Any]:
    first, second = values
    difference = None if first is None or second is None else _rounded(second - first)
    spread = draws[1] - draws[0]
    spread = spread[np.isfinite(spread)]
    interval: list[float] | None = None
    if difference is not None and len(spread) > DRAWS // 2:
        tail = 0.5 * (1.0 - _LEVEL)
        low, middle, high = np.quantile(spread, (tail, 0.5, 1.0 - tail)).tolist()
        interval = [_rounded(middle + wider * (bound - middle)) for bound in (low, high)]
    return {
        "values": [None if value is None else _rounded(value) for value in values],
        "difference": difference,
        "interval": interval,
        "differs": interval is not None and not interval[0] <= 0.0 <= interval[1],
    }


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
