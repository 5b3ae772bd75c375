"""Android's ``dumpsys gfxinfo PACKAGE framestats``: the last 120 frames of each window.

Between two lines ``---PROFILEDATA---`` stands a table of time stamps in ns of the monotonic clock.
A frame took from ``IntendedVsync`` to ``FrameCompleted``; rows whose ``Flags`` are not 0 are
outside the ordinary (a first layout, a resize) and left aside, as Android's documentation says.

Source: AOSP ``frameworks/base/libs/hwui/FrameInfo.h``; developer.android.com, test UI performance.
"""

from pathlib import Path

import numpy as np

from ....base.errors import InputError
from ..log_format import LogFormat, LogHead
from ..log_table import read_log_bytes
from ..render_log import ColumnSource, RenderLog

INSTEAD = (
    "Android framestats hold the last 120 frames and no counters; for a cost model log draw calls "
    "and triangles in the engine"
)
_MARK = "---PROFILEDATA---"
_START, _END = "IntendedVsync", "FrameCompleted"


def read_framestats(path: Path) -> RenderLog:
    """Return the frames of all windows; the log has times and no predictors.

    Raises `InputError` if there is no table, or no frame in it.
    """
    blocks = read_log_bytes(path).decode("utf-8").split(_MARK)[1::2]
    times: list[tuple[int, int]] = []
    flagged = damaged = 0
    for block in blocks:
        rows = [line.strip().split(",") for line in block.split("\n") if line.strip()]
        header = rows[0] if rows else []
        if not {"Flags", _START, _END} <= set(header):
            continue
        places = [header.index(name) for name in ("Flags", _START, _END)]
        for row in rows[1:]:
            cells = [row[place].strip() for place in places if place < len(row)]
            if len(cells) < 3 or not all(cell.isdecimal() and len(cell) < 20 for cell in cells):
                damaged += 1
            elif cells[0] != "0":
                flagged += 1
            else:
                times.append((int(cells[1]), int(cells[2])))
    if not times:
        message = f"expected frames of Android framestats, got none; {INSTEAD}"
        raise InputError(message, path=path)
    start, end = np.array(sorted(times), dtype=np.float64).T
    notes = [f"frame_ms is {_END} - {_START} of Android framestats"]
    notes += [f"{len(blocks)} windows, all read"] if len(blocks) > 1 else []
    notes += [f"left aside {flagged} frames with Flags"] if flagged else []
    return RenderLog(
        name=path.stem,
        format="android-framestats",
        predictors=(),
        counts=np.empty((len(start), 0)),
        frame_ms=(end - start) / 1e6,
        time_s=(start - start[0]) / 1e9,
        header=(("tool", "Android framestats"),),
        notes=tuple(notes),
        warnings=(INSTEAD, *([f"{damaged} rows are damaged and left aside"] if damaged else [])),
        sources=(ColumnSource("frame_ms", f"{_END} - {_START}", "ns"),),
    )


def _recognises(head: LogHead) -> bool:
    return _MARK in head.text or head.header[:2] == ("Flags", _START)


FORMAT = LogFormat(
    "Android framestats (dumpsys gfxinfo); times only",
    _recognises,
    lambda path, _: read_framestats(path),
    predictors=False,
)
