"""What a machine's speed did during a recording, by a draw that was made again and again.

`lodbench record` makes one fixed draw before and after each frame.  Where that takes longer, so
does the frame, whatever is drawn: dividing by it leaves what the frame itself costs.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...traces.logs.render_log import REFERENCES, RenderLog, TimeName

_NEIGHBOURS = 9  # frames, in order of drawing, whose median counts: one draw has noise of its own


@dataclass(frozen=True, slots=True)
class Drift:
    """How a log's machine ran: its reference draw over its median in the first pass.

    Attributes
    ----------
    log : name of the log
    range_pct : from the 5 % to the 95 % point, in per cent
    second_half_pct : mean of the second half drawn over that of the first, minus 1, in per cent
    """

    log: str
    range_pct: float
    second_half_pct: float


def without_drift(log: RenderLog, name: TimeName) -> tuple[RenderLog, Drift | None]:
    """Return a log with a time over the machine's relative slowness, and how it drifted.

    The log itself and None where it has no reference draws.
    """
    order = drawing_order(log)
    ran_ms = running_reference_ms(log.recorded, order)
    if ran_ms is None:
        return log, None
    first = log.recorded.get("pass", np.zeros(len(log))) == 0.0
    slowness = ran_ms / float(np.median(ran_ms[first] if first.any() else ran_ms))
    drawn = slowness[order]
    half = len(drawn) // 2
    low, high = np.quantile(drawn, (0.05, 0.95)).tolist()
    second = float(drawn[half:].mean() / drawn[:half].mean()) - 1.0 if half else 0.0
    drift = Drift(log.name, 100.0 * (high - low), 100.0 * second)
    steady: Any = replace(log, **{name: log.time(name) / slowness})
    return steady, drift


def drawing_order(log: RenderLog) -> NDArray[np.int64]:
    """Return the rows of a log in the order in which they were drawn, pass by pass."""
    nothing = np.zeros(len(log))
    at = log.recorded.get("drawn_at", nothing)
    again = log.recorded.get("pass", nothing)
    return np.lexsort((at, again)).astype(np.int64)


def running_reference_ms(
    recorded: Mapping[str, FloatArray], order: NDArray[np.int64] | None = None
) -> FloatArray | None:
    """Return how long the reference draw took about each frame, (n,) ms; None if nothing says so.

    The mean of the draws before and after a frame, and of that the running median over frames in
    order of drawing.

    Parameters
    ----------
    recorded : columns by name
    order : (n,) rows in order of drawing; None where they stand in it
    """
    from scipy.ndimage import median_filter

    draws = [recorded[name] for name in REFERENCES if name in recorded]
    draw_ms: FloatArray = np.mean(draws, axis=0) if draws else np.empty(0)
    good = np.isfinite(draw_ms) & (draw_ms > 0.0)
    if not good.any():
        return None
    if order is None:
        order = np.arange(len(draw_ms))
    known = order[good[order]]
    smooth: Any = median_filter(draw_ms[known], _NEIGHBOURS, mode="nearest")
    # A frame without a reference is between its neighbours in time.
    place = np.empty(len(draw_ms))
    place[order] = np.arange(len(draw_ms))
    return np.interp(place, place[known], np.asarray(smooth, dtype=np.float64))
