"""The columns `View/Pos*`, `View/Forward*`, `View/Up*` of Unreal's CSV profiler.

Centimetres, left-handed, z up; a row is a frame, and times are the sum of `FrameTime` before it.
The same file serves as a log.  Rows without numbers, such as those of metadata, are left out and
counted.
"""

import csv
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .....base.errors import InputError
from ...camera_trace import Repair
from ...reading.frames import Frame
from ...reading.poses import Poses
from ...reading.rotations import rotations_along
from ...text_lines import read_lines
from ...trace_format import TraceFormat, refuse_selector

if TYPE_CHECKING:
    from .....base.arrays import FloatArray

_PARTS = tuple(f"view/{part}{axis}" for part in ("pos", "forward", "up") for axis in "xyz")
_NEEDED = ("frametime", *_PARTS)
_HEAD = 50  # lines in which the header is looked for


def read_unreal_view(path: Path, selector: str | None = None) -> Poses:
    """Return the view of every frame; raises `InputError` if a column is missing."""
    refuse_selector(selector, path, "Unreal CSV")
    rows = list(enumerate(csv.reader(read_lines(path)), start=1))
    start, header = 0, list[str]()
    for line, row in islice(rows, _HEAD):
        if "view/posx" in map(_plain, row):
            start, header = line, row
            break
    names = list(map(_plain, header))
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise InputError(
            f"expected a column {missing[0]}, got none; record with `csvprofile start` and the "
            "category View",
            path=path,
            line=start or None,
        )
    at = [names.index(name) for name in _NEEDED]
    lines: list[int] = []
    found: list[list[float]] = []
    left_out = 0
    for line, row in rows[start:]:
        numbers = _numbers(row, at)
        if numbers is not None:
            lines.append(line)
            found.append(numbers)
        elif any(row):
            left_out += 1
    table: FloatArray = np.array(found).reshape(-1, len(_NEEDED))
    frame = Frame("opengl", "z", left_handed=True)  # directions are given in place of axes
    return Poses(
        name=path.stem,
        lines=lines,
        time=np.concatenate(((0.0,), np.cumsum(table[:-1, 0]))) if len(table) else table[:, 0],
        time_unit="ms",
        position=table[:, 1:4],
        rotation=rotations_along(table[:, 4:7], table[:, 7:10], path, lines, left_handed=True),
        frame=frame,
        unit="cm",
        repairs=(Repair(left_out, "rows without a view left out"),) if left_out else (),
    )


def _plain(name: str) -> str:
    return name.strip().lower()


def _numbers(row: list[str], at: list[int]) -> list[float] | None:
    try:
        numbers = [float(row[k]) for k in at]
    except (ValueError, IndexError):
        return None
    return numbers if np.isfinite(numbers).all() else None


def _recognises(head: list[str]) -> bool:
    return any("view/posx" in line.lower() for line in head[:_HEAD])


FORMAT = TraceFormat("View columns of Unreal's CSV profiler", _recognises, read_unreal_view)
