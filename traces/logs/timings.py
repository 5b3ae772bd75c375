"""Frame timings: what PresentMon, CapFrameX and OCAT measure of a stream of frames.

The definitions are PresentMon's.  Of frame i, P and E are start and end of Present(), G and R start
and end of its work on the GPU, S the time at which the screen shows it; E′ is the end of the
Present() before, when the CPU begins with the frame (``CPUStart``).  A value that a file lacks is
computed where the definitions give it from others, and is NaN where they do not.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, FloatArray, frozen_array
from ...base.errors import InputError

_CONSECUTIVE_MS = 0.05
"""Two rows are successive presents if their times differ by ``MsBetweenPresents`` this closely."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FrameTimings:
    """Timings of one stream (process and swap chain), one row a present.

    Attributes
    ----------
    dialect : "presentmon", "presentmon-v2", "presentmon-v1", "capframex" or "simulated"
    application, process_id, swap_chain : the stream; -1 and "" where the file does not say
    present_s : P since the capture began; never decreases
    dropped : never shown
    between_presents_ms : P - P of the present before
    frame_ms : E - E′, also called FrameTime
    cpu_busy_ms : P - E′
    in_present_ms : E - P, also called CPUWait
    gpu_latency_ms : G - E′
    gpu_time_ms : R - G
    gpu_busy_ms : time in which the GPU ran work of the process
    until_render_complete_ms : R - P
    until_displayed_ms : S - P
    display_latency_ms : S - E′
    between_display_change_ms : S - S of the frame shown before
    displayed_ms : S of the frame shown next - S
    animation_error_ms : step of E′ - step of S, since the frame shown before
    input_to_photon_ms : S - time of the earliest input that the frame shows
    header : pairs of key and value that the file says of itself
    notes : what the reader chose, decoded or left aside
    generated : frames of a driver's generation, which are left aside
    """

    dialect: str
    application: str
    process_id: int
    swap_chain: str
    present_s: FloatArray
    dropped: BoolArray
    between_presents_ms: FloatArray
    frame_ms: FloatArray
    cpu_busy_ms: FloatArray
    in_present_ms: FloatArray
    gpu_latency_ms: FloatArray
    gpu_time_ms: FloatArray
    gpu_busy_ms: FloatArray
    until_render_complete_ms: FloatArray
    until_displayed_ms: FloatArray
    display_latency_ms: FloatArray
    between_display_change_ms: FloatArray
    displayed_ms: FloatArray
    animation_error_ms: FloatArray
    input_to_photon_ms: FloatArray
    header: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    generated: int = 0

    def __post_init__(self) -> None:
        rows = len(self.present_s)
        if rows == 0:
            raise InputError("expected at least one frame, got none")
        for name in (*_COLUMNS, "dropped"):
            dtype = np.bool_ if name == "dropped" else np.float64
            array = frozen_array(getattr(self, name), dtype, (rows,), name)
            object.__setattr__(self, name, array)
        if not np.all(np.isfinite(self.present_s)) or np.any(np.diff(self.present_s) < 0.0):
            raise InputError("expected present_s to be finite and never to decrease")

    def __len__(self) -> int:
        """Return the number of frames."""
        return len(self.present_s)

    @property
    def cpu_start_s(self) -> FloatArray:
        """E′, when the CPU began with each frame, (n,)."""
        return self.present_s - self.cpu_busy_ms / 1e3


_COLUMNS = tuple(name for name in FrameTimings.__annotations__ if name.endswith(("_ms", "_s")))


def complete_timings(
    known: Mapping[str, FloatArray],
    dropped: BoolArray,
    *,
    dialect: str,
    application: str,
    process_id: int,
    swap_chain: str,
    header: tuple[tuple[str, str], ...] = (),
    notes: tuple[str, ...] = (),
    generated: int = 0,
) -> FrameTimings:
    """Return timings with everything that follows from what is known.

    Parameters
    ----------
    known
        ``present_s`` and any other column of `FrameTimings`, and of version 1 of PresentMon
        ``until_render_start_ms`` (G - P) and ``since_input_ms`` (P - input; 0 where there is none).
    dropped
        (n,); what a dropped frame has of display times is disregarded.

    Raises
    ------
    InputError
        As `FrameTimings`.
    """
    rows = len(dropped)
    columns = {name: np.array(known.get(name, np.full(rows, np.nan))) for name in _COLUMNS}
    for name in _OF_SHOWN:
        columns[name][dropped] = np.nan
    nothing = np.full(rows, np.nan)
    _complete_cpu(columns)
    _complete_gpu(columns, known.get("until_render_start_ms", nothing))
    _complete_display(columns)
    since_input = known.get("since_input_ms", nothing)
    photon = np.where(since_input > 0.0, since_input + columns["until_displayed_ms"], np.nan)
    _fill(columns, "input_to_photon_ms", photon)
    return FrameTimings(
        dialect=dialect,
        application=application,
        process_id=process_id,
        swap_chain=swap_chain,
        dropped=dropped,
        header=header,
        notes=notes,
        generated=generated,
        **columns,
    )


_OF_SHOWN = (
    "until_displayed_ms",
    "display_latency_ms",
    "between_display_change_ms",
    "displayed_ms",
    "animation_error_ms",
    "input_to_photon_ms",
)


def _fill(columns: dict[str, FloatArray], name: str, values: FloatArray) -> None:
    columns[name] = np.where(np.isnan(columns[name]), values, columns[name])


def _complete_cpu(columns: dict[str, FloatArray]) -> None:
    step_ms = np.diff(columns["present_s"], prepend=np.nan) * 1e3
    waited = np.concatenate([[np.nan], columns["in_present_ms"][:-1]])
    between = columns["between_presents_ms"]
    expected = np.where(np.isnan(between), waited + columns["cpu_busy_ms"], between)
    # Where presents are missing from the file, the row before says nothing about this one.
    waited[~(np.abs(step_ms - expected) <= _CONSECUTIVE_MS)] = np.nan
    _fill(columns, "between_presents_ms", waited + columns["cpu_busy_ms"])
    _fill(columns, "cpu_busy_ms", columns["between_presents_ms"] - waited)
    _fill(columns, "frame_ms", columns["cpu_busy_ms"] + columns["in_present_ms"])
    _fill(columns, "in_present_ms", columns["frame_ms"] - columns["cpu_busy_ms"])


def _complete_gpu(columns: dict[str, FloatArray], until_render_start_ms: FloatArray) -> None:
    busy = columns["cpu_busy_ms"]
    _fill(columns, "gpu_latency_ms", until_render_start_ms + busy)
    _fill(columns, "gpu_time_ms", columns["until_render_complete_ms"] - until_render_start_ms)
    complete = columns["gpu_latency_ms"] + columns["gpu_time_ms"] - busy
    _fill(columns, "until_render_complete_ms", complete)


def _complete_display(columns: dict[str, FloatArray]) -> None:
    busy = columns["cpu_busy_ms"]
    _fill(columns, "until_displayed_ms", columns["display_latency_ms"] - busy)
    _fill(columns, "display_latency_ms", columns["until_displayed_ms"] + busy)
    screen_ms = columns["present_s"] * 1e3 + columns["until_displayed_ms"]
    shown = np.flatnonzero(np.isfinite(screen_ms))
    step_ms = np.full(len(busy), np.nan)
    step_ms[shown[1:]] = columns["displayed_ms"][shown[:-1]]
    _fill(columns, "between_display_change_ms", step_ms)
    step_ms[shown[1:]] = np.diff(screen_ms[shown])
    _fill(columns, "between_display_change_ms", step_ms)
    held_ms = np.full(len(busy), np.nan)
    held_ms[shown[:-1]] = columns["between_display_change_ms"][shown[1:]]
    _fill(columns, "displayed_ms", held_ms)
