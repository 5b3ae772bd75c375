"""A simulated run as Chrome trace events: what CPU, GPU and display did, on one time line.

Three threads of one process.  On "CPU" a slice from the input sample of each frame to its
submission, in it the policy's selection (put at the beginning: the log knows its length only), and
after it the wait for a free frame in flight.  On "GPU" the work of each frame.  On "Display" how
long each frame was on the screen, the last for one refresh, and an instant for each frame that was
dropped.  Arrows lead from a frame's input over its GPU work to its display.
"""

from collections.abc import Iterator

from ..frame_log import FrameLog
from .chrome_trace import Phase, TraceEvent

_PID = 1
_CPU, _GPU, _DISPLAY = 1, 2, 3
_THREADS = {_CPU: "CPU", _GPU: "GPU", _DISPLAY: "Display"}
_COUNTERS = ("triangles", "draw_calls", "toggles")
_NS_PER_US = 1e3


def trace_events(log: FrameLog) -> Iterator[TraceEvent]:
    """Yield the events of a run, frame by frame."""
    yield from _names(log)
    following_ns = [*log["input_ns"][1:].tolist(), -1]
    next_display_ns = _next_displays(log)
    select_ms: list[float] = log["select_ms"].tolist()
    counters = {name: log[name].tolist() for name in _COUNTERS}
    for frame, times_ns in enumerate(log.times_ns.tolist()):
        input_ns, cpu_end_ns, gpu_start_ns, gpu_end_ns, display_ns = times_ns
        title = f"frame {frame}"
        select_ns = min(select_ms[frame] * 1e6, cpu_end_ns - input_ns)
        yield _slice(title, _CPU, input_ns, cpu_end_ns, frame)
        yield _slice("policy select", _CPU, input_ns, input_ns + select_ns, frame)
        if following_ns[frame] > cpu_end_ns:
            yield _slice("wait in Present", _CPU, cpu_end_ns, following_ns[frame], frame)
        yield _slice(title, _GPU, gpu_start_ns, gpu_end_ns, frame)
        yield _flow("s", _CPU, input_ns, frame)
        yield _flow("t", _GPU, gpu_start_ns, frame)
        if display_ns >= 0:
            yield _slice(title, _DISPLAY, display_ns, next_display_ns[frame], frame)
            yield _flow("f", _DISPLAY, display_ns, frame)
        else:
            yield TraceEvent(
                ph="i", name=f"dropped {title}", ts=_us(gpu_end_ns), pid=_PID, tid=_DISPLAY, s="t"
            )
        for name, values in counters.items():
            yield TraceEvent(
                ph="C", name=name, ts=_us(input_ns), pid=_PID, args={name: values[frame]}
            )


def _names(log: FrameLog) -> Iterator[TraceEvent]:
    header = log.header
    process = f"lodbench {header.policy} | {header.scene} | {header.trace} | {header.hardware}"
    yield TraceEvent(ph="M", name="process_name", pid=_PID, args={"name": process})
    for tid, name in _THREADS.items():
        yield TraceEvent(ph="M", name="thread_name", pid=_PID, tid=tid, args={"name": name})
        yield TraceEvent(
            ph="M", name="thread_sort_index", pid=_PID, tid=tid, args={"sort_index": tid}
        )


def _next_displays(log: FrameLog) -> list[float]:
    """Return for each frame when the screen shows the next one; one refresh on for the last."""
    refresh_ns = 1e9 / log.header.refresh_hz
    display_ns: list[int] = log["display_ns"].tolist()
    ends_ns: list[float] = [0.0] * len(display_ns)
    next_ns: float | None = None
    for frame in range(len(display_ns) - 1, -1, -1):
        if display_ns[frame] >= 0:
            ends_ns[frame] = display_ns[frame] + refresh_ns if next_ns is None else next_ns
            next_ns = display_ns[frame]
    return ends_ns


def _slice(name: str, tid: int, start_ns: int, end_ns: float, frame: int) -> TraceEvent:
    return TraceEvent(
        ph="X",
        name=name,
        cat="frame",
        ts=_us(start_ns),
        dur=_us(end_ns - start_ns),
        pid=_PID,
        tid=tid,
        args={"frame": frame},
    )


def _flow(phase: Phase, tid: int, time_ns: int, frame: int) -> TraceEvent:
    ends = "e" if phase == "f" else None
    return TraceEvent(
        ph=phase, name="frame", cat="lag", ts=_us(time_ns), pid=_PID, tid=tid, id=frame, bp=ends
    )


def _us(time_ns: float) -> float:
    return round(time_ns / _NS_PER_US, 3)
