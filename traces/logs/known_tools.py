"""Files of known tools that hold no table of frames: named, each with what to record instead."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError
from .log_format import LogHead

_COUNTERS = "log draw calls and triangles beside gpu_ms in the engine"


@dataclass(frozen=True, slots=True)
class KnownTool:
    """A tool whose files cannot serve.

    Attributes
    ----------
    what : the file, in words
    is_it : takes the head and the path of a file
    instead : what to do
    """

    what: str
    is_it: Callable[[LogHead, Path], bool]
    instead: str


def _magic(*starts: bytes) -> Callable[[LogHead, Path], bool]:
    return lambda head, _: head.data.startswith(starts)


def _suffix(*suffixes: str) -> Callable[[LogHead, Path], bool]:
    return lambda _, path: path.name.lower().endswith(suffixes)


def _columns(*names: str) -> Callable[[LogHead, Path], bool]:
    wanted = {name.lower() for name in names}
    return lambda head, _: wanted <= {name.lower() for name in head.header}


def _text(*parts: str) -> Callable[[LogHead, Path], bool]:
    return lambda head, _: all(part in head.text for part in parts)


def _is_any(*tests: Callable[[LogHead, Path], bool]) -> Callable[[LogHead, Path], bool]:
    return lambda head, path: any(test(head, path) for test in tests)


KNOWN_TOOLS = (
    KnownTool(
        "a binary capture of Unreal's CSV profiler",
        _is_any(
            _suffix(".csv.bin"),
            lambda head, path: path.suffix == ".bin" and b"CSV" in head.data[:16],
        ),
        "convert it with Unreal's CsvConvert, or capture with -csvGzip and no binary",
    ),
    KnownTool(
        "an archive packed with gzip", _magic(b"\x1f\x8b"), "unpack it first, as gzip -d does"
    ),
    KnownTool("a RenderDoc capture", _magic(b"RDOC"), f"it holds one frame; {_COUNTERS}"),
    KnownTool(
        "RenderDoc's list of events",
        _is_any(_columns("EID", "Name"), _columns("EID", "Event"), _columns("EID", "Action")),
        f"it holds one frame; {_COUNTERS}",
    ),
    KnownTool("a PIX capture", _suffix(".wpix", ".pix3"), f"PIX holds one frame; {_COUNTERS}"),
    KnownTool(
        "PIX's list of events",
        _is_any(
            _columns("Global ID", "Name"),
            _columns("Queue ID", "Name"),
            _text("EOP to EOP Duration"),
            _text("TOP to EOP Duration"),
        ),
        f"it holds one frame; {_COUNTERS}",
    ),
    KnownTool(
        "a report of Nsight",
        _is_any(_suffix(".nsys-rep", ".qdrep", ".ncu-rep", ".ngfx-capture", ".ngfx-gputrace")),
        f"Nsight's reports have no table of frames; {_COUNTERS}",
    ),
    KnownTool(
        "a data base of SQLite, as Nsight Systems exports",
        _magic(b"SQLite format 3"),
        f"it has no table of frames; {_COUNTERS}",
    ),
    KnownTool(
        "a summary of Nsight",
        _is_any(
            _columns("Total Time (ns)", "Instances"),
            _columns("Total Time (ns)", "Num Calls"),
            _columns("Start (ns)", "Duration (ns)"),
            _columns("ID", "Kernel Name", "Metric Name"),
        ),
        f"it is summed by call, not by frame; {_COUNTERS}",
    ),
    KnownTool(
        "a log of Unreal's ProfileGPU",
        lambda head, _: "LogRHI" in head.text and " prims " in head.text,
        "it holds one frame by pass; capture with csvprofile start, which has GPUTime, "
        "RHI/DrawCalls and RHI/PrimitivesDrawn for each frame",
    ),
    KnownTool(
        "the summary of FrameView",
        _is_any(
            _columns("Avg FPS", "Application"),
            lambda _, path: "frameview_summary" in path.name.lower(),
        ),
        "give the log of the run itself, FrameView_…_Log.csv, which has every frame",
    ),
    KnownTool(
        "PresentMon's statistics of a run",
        _columns("Duration", "Total Frames", "Average FPS"),
        "give the capture itself, which has every frame",
    ),
    KnownTool(
        "Fraps' frame rates by second",
        lambda head, _: head.header in (("FPS",), ("fps",)) or head.lines[:1] == ["FPS"],
        "tick Frametimes in Fraps, and give the file … frametimes.csv",
    ),
    KnownTool(
        "Fraps' summary",
        _columns("Frames", "Time (ms)", "Min", "Max", "Avg"),
        "tick Frametimes in Fraps, and give the file … frametimes.csv",
    ),
    KnownTool(
        "the summary of an RTSS benchmark",
        _text("benchmark completed", "frames rendered in"),
        "record every frame with PresentMon or CapFrameX",
    ),
    KnownTool("a folder packed with zip, as .xlsx is", _magic(b"PK\x03\x04"), "save it as CSV"),
    KnownTool(
        "a trace of Perfetto or of Chrome",
        lambda _, path: path.suffix in (".perfetto-trace", ".pftrace"),
        "export the counters as CSV",
    ),
    KnownTool(
        "a trace of Event Tracing for Windows", _suffix(".etl"), "give PresentMon's CSV of it"
    ),
)
"""Tools by their files; the first that takes a file names it."""


def refuse_known_tool(head: LogHead, path: Path) -> None:
    """Raise InputError if a file is of a tool whose files hold no table of frames."""
    for tool in KNOWN_TOOLS:
        if tool.is_it(head, path):
            message = f"expected a log with a row for each frame, got {tool.what}"
            raise InputError(f"{message}; {tool.instead}", path=path)
