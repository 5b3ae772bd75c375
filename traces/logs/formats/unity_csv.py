"""CSV of Unity's profiler counters, as a script with ``ProfilerRecorder`` writes it.

There is no standard file: the columns are the counters' names (``Draw Calls Count``, ``Triangles
Count``, ``GPU Frame Time``…).  Counters of time are nanoseconds, the ``FrameTiming`` struct has
milliseconds, and scripts write either, so the unit comes from the values.  ``cpu_ms`` is the longer
of main and render thread.  Profile Analyzer's frame CSV (``Frame Time (ms)`` between semicolons) is
read for its times.
"""

from pathlib import Path

from ..log_format import Columns, LogFormat
from ..log_table import read_log_bytes, split_table
from ..render_log import RenderLog
from .log_csv import log_of_table

_MARKS = frozenset(
    (
        *("CPU Total Frame Time", "CPU Main Thread Frame Time", "CPU Render Thread Frame Time"),
        *("GPU Frame Time", "SetPass Calls Count", "Draw Calls Count", "Batches Count"),
        *("Triangles Count", "Vertices Count", "Time from first frame (ms)"),
    )
)


def read_unity_csv(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log of a CSV of counters; mapped columns go before the usual ones.

    Raises `InputError` as `read_csv_log`.
    """
    return log_of_table(split_table(read_log_bytes(path), path), mapping, "unity")


FORMAT = LogFormat(
    "Unity's profiler counters as CSV",
    lambda head: not _MARKS.isdisjoint(head.header),
    read_unity_csv,
)
