"""Nuke's `.chan`: frame, position, rotations about x, y and z in degrees, vertical field of view.

OpenGL camera, y up.  The file says neither its rotation order nor its frames a second: ZXY is
taken, the order that Nuke starts with, and the rate is asked for.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np

from .....base.errors import InputError
from ...reading.frames import OPENGL
from ...reading.poses import Poses
from ...text_lines import data_lines, parse_numbers
from ...trace_format import TraceFormat, refuse_selector

_NAMES = ("frame", "tx", "ty", "tz", "rx", "ry", "rz", "fov")


def read_chan(path: Path, selector: str | None = None) -> Poses:
    """Return the poses; raises `InputError` for a row that has not 7 or 8 numbers."""
    from scipy.spatial.transform import Rotation

    refuse_selector(selector, path, ".chan")
    lines: list[int] = []
    rows: list[list[float]] = []
    for line, text in data_lines(path):
        fields = text.split()
        names = _NAMES[: max(7, min(len(fields), 8))]
        rows.append(parse_numbers(fields, names, path=path, line=line))
        lines.append(line)
    if len({len(row) for row in rows}) > 1:
        raise InputError("expected rows of one length, got 7 and 8 numbers", path=path)
    table = np.array(rows).reshape(-1, len(rows[0]) if rows else 7)
    # Applied z first, then x, then y: Ry Rx Rz.
    turns = Rotation.from_euler("YXZ", table[:, [5, 4, 6]], degrees=True)
    return Poses(
        name=path.stem,
        lines=lines,
        time=table[:, 0],
        position=table[:, 1:4],
        rotation=turns.as_matrix(),
        frame=OPENGL,
        fovy_deg=float(np.median(table[:, 7])) if table.shape[1] == 8 and len(table) else None,
        assumed=("rotations in the order ZXY",),
    )


def _recognises(head: list[str]) -> bool:
    rows = [line.split() for line in head if not line.startswith("#")][:20]
    if len(rows) < 2 or {len(row) for row in rows} not in ({7}, {8}):
        return False
    try:
        frames = [float(row[0]) for row in rows]
    except ValueError:
        return False
    return all(later - frame == 1.0 for frame, later in pairwise(frames))


FORMAT = TraceFormat(".chan of Nuke, frames without a rate", _recognises, read_chan)
