"""Trace events: what Perfetto shows of a run."""

import json
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import get_args

import msgspec
import numpy as np
import pytest

from lodbench.models.machine.hardware import DisplayMode
from lodbench.sim.export.chrome_trace import TraceEvent
from lodbench.sim.export.export import EXPORTS
from lodbench.sim.export.trace_events import trace_events
from lodbench.sim.frame_log import COUNTS, FrameLog

CPU, GPU, DISPLAY = 1, 2, 3
Replay = Callable[..., FrameLog]
MODES: tuple[DisplayMode, ...] = get_args(DisplayMode)


def slices(
    events: tuple[TraceEvent, ...], tid: int, name: str = "frame"
) -> list[tuple[float, float]]:
    """Return start and end in microseconds of the slices of a thread with this name."""
    return [
        (event.ts or 0.0, (event.ts or 0.0) + (event.dur or 0.0))
        for event in events
        if event.ph == "X" and event.tid == tid and event.name.startswith(name)
    ]


def by_hand(run_pipeline: Replay) -> FrameLog:
    """Return three frames, the second dropped; its policy is said to take more than the CPU did."""
    log = run_pipeline("immediate", frames=3)
    rows = [
        [0, 4_000_000, 4_000_000, 9_000_000, 9_000_000],
        [5_000_000, 8_000_000, 9_000_000, 16_000_000, -1],
        [8_000_000, 12_000_000, 16_000_000, 20_000_000, 20_000_500],
    ]
    counts = log.counts.copy()
    counts[:, COUNTS.index("select_ms")] = [1.0, 7.0, 0.5]
    return FrameLog(log.header, np.array(rows), counts)


def test_hand_worked_slices(run_pipeline: Replay) -> None:
    """Slices begin and end where the frame log says; the last display lasts one refresh."""
    events = tuple(trace_events(by_hand(run_pipeline)))
    assert slices(events, CPU) == [(0, 4000), (5000, 8000), (8000, 12000)]
    assert slices(events, CPU, "policy") == [(0, 1000), (5000, 8000), (8000, 8500)]
    assert slices(events, CPU, "wait") == [(4000, 5000)]
    assert slices(events, GPU) == [(4000, 9000), (9000, 16000), (16000, 20000)]
    shown = slices(events, DISPLAY)
    assert shown[0] == pytest.approx((9000, 20000.5))
    assert shown[1] == pytest.approx((20000.5, 20000.5 + 1e6 / 90), abs=1e-3)
    dropped = [(event.name, event.ts, event.tid) for event in events if event.ph == "i"]
    assert dropped == [("dropped frame 1", 16000.0, DISPLAY)]


@pytest.mark.parametrize("mode", MODES)
def test_written_trace_is_what_perfetto_reads(
    tmp_path: Path, mode: DisplayMode, run_pipeline: Replay
) -> None:
    """Names, phases and fields are those of the format, in each display mode."""
    log = run_pipeline(mode, frames=120)
    EXPORTS["chrome-trace"].write(log, tmp_path / "run.json")
    document = json.loads((tmp_path / "run.json").read_text())
    events = msgspec.convert(document["traceEvents"], tuple[TraceEvent, ...])
    names = {
        (event.name, event.tid): (event.args or {}).get("name")
        for event in events
        if event.ph == "M" and event.name != "thread_sort_index"
    }
    assert names == {
        ("process_name", 0): "lodbench feedback:gain=0.5,delay=2 | scene | trace | machine",
        ("thread_name", CPU): "CPU",
        ("thread_name", GPU): "GPU",
        ("thread_name", DISPLAY): "Display",
    }
    assert {event.pid for event in events} == {1}
    assert {event.ph for event in events} <= set("MXsftCi")
    assert len(slices(events, CPU)) == len(slices(events, GPU)) == 120
    assert len(slices(events, DISPLAY)) == np.count_nonzero(log["display_ns"] >= 0)


@pytest.mark.parametrize("mode", MODES)
def test_slices_of_a_thread_nest(mode: DisplayMode, run_pipeline: Replay) -> None:
    """On each thread a slice ends before the next begins, or lies in the one before."""
    threads: defaultdict[object, list[tuple[float, float]]] = defaultdict(list)
    for event in trace_events(run_pipeline(mode)):
        if event.ph == "X":
            assert event.ts is not None
            assert event.dur is not None
            threads[event.tid].append((event.ts, event.ts + event.dur))
    for spans in threads.values():
        outer_start, outer_end = -1.0, -1.0
        for start, end in spans:
            inside = outer_start <= start and end <= outer_end + 1e-3
            assert inside or start >= outer_end - 1e-3
            if not inside:
                outer_start, outer_end = start, end


def test_arrows_lead_from_input_to_display(run_pipeline: Replay) -> None:
    """A frame's flow begins at its input and ends at its display, in a slice of that thread."""
    log = run_pipeline("mailbox", frames=60)
    events = tuple(trace_events(log))
    starts = {event.id: event.ts for event in events if event.ph == "s"}
    ends = {event.id: event.ts for event in events if event.ph == "f"}
    shown = np.flatnonzero(log["display_ns"] >= 0)
    assert set(ends) == set(shown.tolist())
    lag_us = [(ends[frame] or 0.0) - (starts[frame] or 0.0) for frame in shown.tolist()]
    assert lag_us == pytest.approx((log["display_ns"] - log["input_ns"])[shown] / 1e3)
    begun = {start for start, _ in slices(events, DISPLAY)}
    assert set(ends.values()) == begun


def test_counters_are_those_of_the_log(run_pipeline: Replay) -> None:
    """Triangles, draw calls and toggles are series over the input times."""
    log = run_pipeline("vsync", frames=30)
    for name in ("triangles", "draw_calls", "toggles"):
        counters = [
            (event.ts, (event.args or {})[name])
            for event in trace_events(log)
            if event.ph == "C" and event.name == name
        ]
        assert [value for _, value in counters] == log[name].tolist()
        assert [ts for ts, _ in counters] == pytest.approx((log["input_ns"] / 1e3).tolist())
