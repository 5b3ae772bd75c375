"""Two logs of one run joined by time: a capture's times, and an engine's counts.

PresentMon knows when frames were presented and how long they took; the engine knows what it drew.
Their clocks may begin at different moments, so the offset is looked for: none, the beginnings, or,
where the counts come with frame times, the shift at which both logs' frame times agree best.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from .log_build import STEPS
from .render_log import RenderLog

_NEAREST = 0.6  # of a frame, within which a row of counts belongs to it
_OVERLAP = 0.5  # of the shorter log, from which clocks are taken to be one
_FEWEST = 30  # frames that must be joined
_AGREE = 0.5  # correlation of frame times from which a shift is believed
_SHIFTS = 2_000  # half frames, either way


@dataclass(frozen=True, slots=True)
class _Offset:
    seconds: float
    why: str
    doubt: str = ""


def join_by_time(times: RenderLog, counts: RenderLog) -> RenderLog:
    """Return the times of one log with the counts of another, for frames that both have.

    A row of counts belongs to the frame that is nearest in time, within 0.6 of a frame; a frame
    takes one row at most.  Busy times that only the other log has come along.

    Raises `InputError` if either has no clock, the other has no counts, or too few rows agree.
    """
    for log in (times, counts):
        if log.time_s is None or np.isfinite(log.time_s).sum() < 2:
            raise InputError(
                f"{log.name}: expected a clock to join by, got a log without; "
                "log a time for each frame, or --map time_s=COLUMN"
            )
    if not counts.predictors:
        raise InputError(f"{counts.name}: expected counts to join, got a log with times alone")
    step_s = _step_s(times)
    offset = _offset(times, counts, step_s)
    clock, other = _clock(times), _clock(counts) + offset.seconds
    frames, rows = _pairs(clock, other, _NEAREST * step_s)
    if len(frames) < min(_FEWEST, len(counts), len(times)):
        raise InputError(
            f"{counts.name}: expected rows at the times of {times.name}, got {len(frames)} of "
            f"{len(counts)} within {_NEAREST:g} of a frame ({offset.why}); are both of one run?"
        )
    columns = {
        name: getattr(times, name)[frames]
        for name in ("frame_ms", "gpu_ms", "cpu_ms", "time_s")
        if getattr(times, name) is not None
    }
    for name in ("gpu_ms", "cpu_ms"):
        if name not in columns and getattr(counts, name) is not None:
            columns[name] = getattr(counts, name)[rows]
    note = (
        f"{len(frames):,} of {len(counts):,} rows of {counts.name} joined by time to "
        f"{len(times):,} frames, {offset.why}"
    )
    return replace(
        times,
        predictors=counts.predictors,
        counts=counts.counts[rows],
        **columns,
        notes=(*times.notes, *counts.notes, note),
        warnings=(*filter(None, (offset.doubt,)), *_still_true(times), *counts.warnings),
        sources=(*times.sources, *(s for s in counts.sources if s.name in counts.predictors)),
        timings=None,
    )


def _still_true(times: RenderLog) -> list[str]:
    return [warning for warning in times.warnings if "for a cost model" not in warning]


def _clock(log: RenderLog) -> FloatArray:
    assert log.time_s is not None
    return log.time_s


def _step_s(log: RenderLog) -> float:
    steps = np.diff(_clock(log))
    steps = steps[np.isfinite(steps) & (steps > 0.0)]
    if not len(steps):
        raise InputError(f"{log.name}: expected a clock that runs, got one that stands still")
    return float(np.median(steps))


def _offset(times: RenderLog, counts: RenderLog, step_s: float) -> _Offset:
    clock, other = _clock(times), _clock(counts)
    ends = [(float(np.nanmin(c)), float(np.nanmax(c))) for c in (clock, other)]
    shared = min(end for _, end in ends) - max(start for start, _ in ends)
    shortest = min(end - start for start, end in ends)
    begins = ends[0][0] - ends[1][0]
    one_clock = shared >= _OVERLAP * shortest
    tried = (0.0, begins) if one_clock else (begins,)
    found = _by_frame_times(times, counts, tried, step_s)
    if found is not None:
        return _Offset(found, f"clocks {found:+.4g} s apart by their frame times")
    doubt = ""
    if _have_times(times, counts):
        doubt = (
            "their frame times agree at no shift of the clocks: make sure that both are of one run"
        )
    if one_clock:
        return _Offset(0.0, "on one clock", doubt)
    why = "taken to begin together, as nothing says how far the clocks are apart"
    return _Offset(begins, why, doubt)


def _by_frame_times(
    times: RenderLog, counts: RenderLog, tried: Sequence[float], step_s: float
) -> float | None:
    """Return the offset at which both logs' frame times agree best, or None."""
    if not _have_times(times, counts):
        return None
    assert times.frame_ms is not None
    assert counts.frame_ms is not None
    clock, other = _clock(times), _clock(counts)
    good = np.isfinite(clock) & (times.frame_ms > 0.0)
    also = np.isfinite(other) & (counts.frame_ms > 0.0)
    if good.sum() < _FEWEST or also.sum() < _FEWEST:
        return None
    order = np.argsort(clock[good], kind="stable")
    at, values = clock[good][order], times.frame_ms[good][order]
    rows, wanted = other[also], counts.frame_ms[also]
    best, best_s = _AGREE, None
    steps = 0.5 * step_s * np.arange(-_SHIFTS, _SHIFTS + 1)
    for offset in np.concatenate([near + steps for near in tried]).tolist():
        inside = (rows + offset >= at[0]) & (rows + offset <= at[-1])
        if inside.sum() < max(_FEWEST, _OVERLAP * min(len(rows), len(at))):
            continue
        seen = values[_nearest(at, rows[inside] + offset)]
        agree = _correlation(seen, wanted[inside])
        if agree > best + 1e-9:
            best, best_s = agree, offset
    if best_s is None:
        return None
    # Between frames the nearest stays the same over a frame's width: its middle is taken.
    inside = (rows + best_s >= at[0]) & (rows + best_s <= at[-1])
    seen_at = at[_nearest(at, rows[inside] + best_s)]
    return best_s + float(np.median(seen_at - rows[inside] - best_s))


def _have_times(*logs: RenderLog) -> bool:
    """Return whether all logs have frame times that are no steps of their clocks."""
    return all(
        log.frame_ms is not None
        and not any(s.name == "frame_ms" and s.source.startswith(STEPS) for s in log.sources)
        for log in logs
    )


def _correlation(one: FloatArray, other: FloatArray) -> float:
    one, other = one - one.mean(), other - other.mean()
    size = float(np.sqrt((one @ one) * (other @ other)))
    return float(one @ other) / size if size > 0.0 else 0.0


def _nearest(sorted_clock: FloatArray, wanted: FloatArray) -> np.ndarray:
    after = np.clip(np.searchsorted(sorted_clock, wanted), 1, len(sorted_clock) - 1)
    before_is_nearer = wanted - sorted_clock[after - 1] <= sorted_clock[after] - wanted
    return after - before_is_nearer


def _pairs(clock: FloatArray, other: FloatArray, within_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return frames and rows that belong together, each at most once, by the frames' order."""
    frames = np.flatnonzero(np.isfinite(clock))
    frames = frames[np.argsort(clock[frames], kind="stable")]
    rows = np.flatnonzero(np.isfinite(other))
    near = frames[_nearest(clock[frames], other[rows])]
    apart = np.abs(clock[near] - other[rows])
    best: dict[int, tuple[float, int]] = {}
    for frame, row, gap in zip(near.tolist(), rows.tolist(), apart.tolist(), strict=True):
        if gap <= within_s and (frame not in best or gap < best[frame][0]):
            best[frame] = (gap, row)
    chosen = sorted(best)
    return np.array(chosen, dtype=np.intp), np.array([best[f][1] for f in chosen], dtype=np.intp)
