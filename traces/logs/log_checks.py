"""What makes the times of a log unfit for a cost model, each with its own message.

A finding that refuses says that the column carries no cost at all; the others say what to beware
of.  The traps are those found in real logs.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from .checks.caps import capped_at_hz
from .checks.late import frames_late
from .render_log import TIMES, RenderLog, TimeName

_ENOUGH_FRAMES = 30  # below, nothing can be said of a distribution
_SLOWEST_MS = 1e4  # longer is a pause, not a frame
_STALE = 0.05  # share of values that repeat the one before
_COVERED = 0.9  # share of the elapsed time that the frames' times add up to
_STILL = 0.05  # coefficient of variation of predictors, below which a view stands still
_SOFTWARE = ("llvmpipe", "softpipe", "swiftshader", "swrast")


@dataclass(frozen=True, slots=True)
class Finding:
    """Something about a log that a fit must know.

    Attributes
    ----------
    kind : short name of the trap
    column : the time that it is about, or "" for the whole log
    refuse : whether a fit of that time would be worthless
    message : what was found and what to do, one line
    """

    kind: str
    column: str
    refuse: bool
    message: str

    def __str__(self) -> str:
        return self.message


def check_log(log: RenderLog) -> tuple[Finding, ...]:
    """Return what is wrong with a log, times in the order of `TIMES`, then the log as a whole."""
    of_times = [
        Finding(kind, name, refuse, message)
        for name in TIMES
        if name in log.times
        for kind, refuse, check in _CHECKS_OF_TIMES
        if (message := check(log, name))
    ]
    of_log = [
        Finding(kind, "", refuse, message)
        for kind, refuse, check in _CHECKS_OF_LOGS
        if (message := check(log))
    ]
    return (*of_times, *of_log)


def _capped(log: RenderLog, name: TimeName) -> str | None:
    """Look at intervals alone: a busy time near a refresh is the time of honest work."""
    if name != "frame_ms":
        return None
    names: tuple[TimeName, ...] = ("gpu_ms", "cpu_ms")
    busy: list[TimeName] = [other for other in names if other in log.times]
    load = [log.counts, *(log.time(other)[:, np.newaxis] for other in busy)]
    rate = capped_at_hz(log.time(name), _without_holes(np.hstack(load)))
    if rate is None:
        return None
    advice = f"fit {' or '.join(busy)}" if busy else "log a busy time, or switch the cap off"
    return (
        f"{name} is tied to a clock of {rate:.4g} Hz (a refresh or a frame cap), so it carries no "
        f"cost; {advice}"
    )


def _without_holes(load: FloatArray) -> FloatArray:
    """Leave out what most frames lack, so that the others can be a control."""
    if not load.shape[1]:
        return load
    bearable = np.abs(load) < 1e15
    return np.where(bearable, load, np.nan)[:, bearable.mean(axis=0) > 0.5]


def _late(log: RenderLog, name: TimeName) -> str | None:
    lag, so, now = frames_late(log, name)
    if not lag:
        return None
    return (
        f"{name} is late by {lag} {'frame' if lag == 1 else 'frames'}: counts of {lag} rows before "
        f"explain {so:.0%} of its variance, those of its own row {max(now, 0.0):.0%}"
    )


def _stale(log: RenderLog, name: TimeName) -> str | None:
    time = log.time(name)
    time = time[np.isfinite(time) & (time > 0.0)]
    if len(time) < _ENOUGH_FRAMES:
        return None
    step: FloatArray = np.abs(np.diff(time))
    repeats = np.count_nonzero(step == 0.0) / len(step)
    # Times written to a tenth of a millisecond repeat too, but no oftener than they move by the
    # least that they can.
    least = float(step[step > 0.0].min(initial=np.inf))
    nearly = np.count_nonzero((step > 0.0) & (step < 2.5 * least)) / len(step)
    if repeats <= max(_STALE, nearly):
        return None
    return (
        f"{name} repeats the value before in {repeats:.0%} of frames: read-back is late, so rows "
        "pair a time with another frame's predictors; average over some frames, or log later"
    )


def _unmeasured(log: RenderLog, name: TimeName) -> str | None:
    time = log.time(name)
    bad = float(np.mean(~(time > 0.0)))
    if bad <= 0.5:
        return None
    return f"{name} is missing, zero or negative in {bad:.0%} of frames: the tool did not have it"


def _software_timer(log: RenderLog, name: TimeName) -> str | None:
    renderer = " ".join(value for _, value in log.header).lower()
    if name != "gpu_ms" or not any(software in renderer for software in _SOFTWARE):
        return None
    return (
        "gpu_ms is a software rasteriser's timer query, which ends before rasterisation does; "
        "fit frame_ms"
    )


def _sampled(log: RenderLog) -> str | None:
    if log.time_s is None or log.frame_ms is None:
        return None
    good = np.isfinite(log.time_s) & (log.frame_ms > 0.0) & (log.frame_ms < _SLOWEST_MS)
    clock, total_s = log.time_s[good], float(log.frame_ms[good].sum()) / 1e3
    span = float(clock[-1] - clock[0]) if len(clock) > 1 else 0.0
    if span <= 0.0 or total_s >= _COVERED * span:
        return None
    return (
        f"frame times add up to {total_s / span:.1%} of the elapsed {span:.4g} s: the log is "
        "sampled, so successive rows are not successive frames; log every frame"
    )


def _backwards(log: RenderLog) -> str | None:
    if log.time_s is None:
        return None
    clock = log.time_s[np.isfinite(log.time_s)]
    back = int((clock[1:] < clock[:-1]).sum())
    if back == 0:
        return None
    return (
        f"time runs backwards {back} times: several captures, processes or swap chains in one "
        "file; split it"
    )


def _still(log: RenderLog) -> str | None:
    if not log.predictors or len(log) < 2:
        return None
    counts = log.counts[np.isfinite(log.counts).all(axis=1)]
    if len(counts) < 2:
        return None
    with np.errstate(over="ignore", invalid="ignore"):  # counts near the largest number
        mean = counts.mean(axis=0)
        varied = counts.std(axis=0)[mean > 0.0] / mean[mean > 0.0]
    if not len(varied) or not varied.max() < _STILL:
        return None
    return (
        f"no predictor varies by more than {varied.max():.1%}: the view stands still, and cost "
        "cannot be told apart from set-up; log a walk through different views"
    )


# Kind, whether it refuses, and the check, which returns the message if there is one.
_CHECKS_OF_TIMES: tuple[tuple[str, bool, Callable[[RenderLog, TimeName], str | None]], ...] = (
    ("capped", True, _capped),
    ("late", False, _late),
    ("stale", False, _stale),
    ("unmeasured", True, _unmeasured),
    ("software-timer", True, _software_timer),
)
_CHECKS_OF_LOGS: tuple[tuple[str, bool, Callable[[RenderLog], str | None]], ...] = (
    ("sampled", False, _sampled),
    ("backwards", False, _backwards),
    ("still", True, _still),
)
