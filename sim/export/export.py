"""A simulated run as files for the viewers that users already have.

How the pipeline maps onto PresentMon's definitions (`lodbench.traces.logs.timings`): Present()
begins when the CPU has submitted a frame, and returns when the next frame may begin, so that its
wait is the wait for a free frame in flight.  The CPU starts with a frame where its input is
sampled: DisplayLatency is the lag.  The first frame of a run makes no row, as the first present of
a swap chain makes none in PresentMon, because it has no present before it.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...traces.logs.formats.capframex import write_capframex
from ...traces.logs.presentmon_writer import write_presentmon
from ...traces.logs.timings import FrameTimings, complete_timings
from ..frame_log import FrameLog, LogHeader
from .chrome_trace import write_chrome_trace
from .trace_events import trace_events

_NS_PER_MS, _NS_PER_S = 1e6, 1e9


def frame_timings(log: FrameLog) -> FrameTimings:
    """Return what PresentMon would have measured of a run, from its second frame on.

    Raises `InputError` if the run has fewer than two frames.
    """
    if len(log) < 2:
        raise InputError(f"expected a run of at least 2 frames, got {len(log)}; replay more frames")
    cpu_start, present, display = log["input_ns"], log["cpu_end_ns"], log["display_ns"]
    gpu_start, gpu_end = log["gpu_start_ns"], log["gpu_end_ns"]
    following = np.append(cpu_start[1:], -1)
    shown = display >= 0
    world_ms, screen_ms = _since_shown(cpu_start, shown), _since_shown(display, shown)
    known: dict[str, FloatArray] = {
        "present_s": present / _NS_PER_S,
        "between_presents_ms": np.diff(present, prepend=present[0]) / _NS_PER_MS,
        "frame_ms": _between(cpu_start, following),
        "cpu_busy_ms": _between(cpu_start, present),
        "in_present_ms": _between(present, following),
        "gpu_latency_ms": _between(cpu_start, gpu_start),
        "gpu_time_ms": _between(gpu_start, gpu_end),
        "gpu_busy_ms": _between(gpu_start, gpu_end),
        "until_render_complete_ms": _between(present, gpu_end),
        "until_displayed_ms": _between(present, display),
        "display_latency_ms": _between(cpu_start, display),
        "between_display_change_ms": screen_ms,
        "animation_error_ms": world_ms - screen_ms,
    }
    return complete_timings(
        {name: values[1:] for name, values in known.items()},
        ~shown[1:],
        dialect="simulated",
        application="lodbench-" + re.sub(r"[^A-Za-z0-9.]+", "-", log.header.policy).strip("-"),
        process_id=1,
        swap_chain="0x1",
    )


def _between(start_ns: NDArray[np.int64], end_ns: NDArray[np.int64]) -> FloatArray:
    """Return milliseconds, NaN where a frame never got to either."""
    reached = (start_ns >= 0) & (end_ns >= 0)
    return np.where(reached, (end_ns - start_ns) / _NS_PER_MS, np.nan)


def _since_shown(time_ns: NDArray[np.int64], shown: NDArray[np.bool_]) -> FloatArray:
    """Return milliseconds since the frame shown before, NaN for frames never shown."""
    at = np.flatnonzero(shown)
    since_ms = np.full(len(time_ns), np.nan)
    since_ms[at[1:]] = np.diff(time_ns[at]) / _NS_PER_MS
    return since_ms


@dataclass(frozen=True, slots=True)
class Export:
    """A format: how its files end, and how a run is written to one."""

    suffix: str
    write: Callable[[FrameLog, Path], None]


def _write_presentmon(log: FrameLog, path: Path) -> None:
    sync_interval, tearing = _presents(log.header)
    write_presentmon(path, frame_timings(log), sync_interval=sync_interval, tearing=tearing)


def _write_capframex(log: FrameLog, path: Path) -> None:
    header = log.header
    sync_interval, tearing = _presents(header)
    comment = (
        f"simulated by lodbench: policy {header.policy}, scene {header.scene}, trace "
        f"{header.trace}, hardware {header.hardware}, budget {header.budget_ms:g} ms, seed "
        f"{header.seed}"
    )
    write_capframex(
        path, frame_timings(log), comment=comment, sync_interval=sync_interval, tearing=tearing
    )


def _write_chrome_trace(log: FrameLog, path: Path) -> None:
    write_chrome_trace(path, trace_events(log))


def _presents(header: LogHeader) -> tuple[int, bool]:
    """Return sync interval and tearing that a program asks of Present() for a display mode."""
    return int(header.display_mode == "vsync"), header.display_mode == "immediate"


EXPORTS = {
    "presentmon": Export(".presentmon.csv", _write_presentmon),
    "capframex": Export(".capframex.json", _write_capframex),
    "chrome-trace": Export(".trace.json", _write_chrome_trace),
}
