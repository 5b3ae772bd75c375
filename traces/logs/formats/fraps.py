"""Frame times as Fraps, and RTSS after it, write them: ``Frame, Time (ms)``, cumulated.

The time is that of each present since the first, so that frame times are its differences.
"""

from pathlib import Path

import numpy as np

from ....base.errors import InputError
from ..log_format import LogFormat, LogHead
from ..log_table import read_log_bytes, split_table
from ..render_log import ColumnSource, RenderLog


def read_fraps(path: Path) -> RenderLog:
    """Return the times of a benchmark; it has no predictors.

    Raises `InputError` if there are fewer than two frames, or no numbers.
    """
    table = split_table(read_log_bytes(path), path)
    values, odd = table.measure([1])
    present_ms = values[np.isfinite(values[:, 0]), 0]
    if len(present_ms) < 2:
        raise InputError("expected two frames or more, got fewer; record again", path=path)
    steps_ms = np.diff(present_ms)
    note = "frame_ms is the step of Fraps' Time (ms), the time of each present"
    return RenderLog(
        name=path.stem,
        format="fraps",
        predictors=(),
        counts=np.empty((len(steps_ms), 0)),
        frame_ms=np.where(steps_ms > 0.0, steps_ms, np.nan),
        time_s=present_ms[1:] / 1e3,
        notes=(note,),
        warnings=odd,
        sources=(ColumnSource("frame_ms", "steps of Time (ms)", "ms"),),
    )


def _recognises(head: LogHead) -> bool:
    return tuple(name.lower() for name in head.header) == ("frame", "time (ms)")


FORMAT = LogFormat(
    "Fraps' frametimes; times only", _recognises, lambda path, _: read_fraps(path), predictors=False
)
