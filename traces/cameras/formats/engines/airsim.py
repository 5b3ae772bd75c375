"""AirSim's `airsim_rec.txt`: tab-separated, milliseconds since 1970, quaternion w first, NED axes.

Shah et al., "AirSim: high-fidelity visual and physical simulation for autonomous vehicles", Field
and Service Robotics 2017.  The pose is that of the vehicle; the camera looks ahead from it.
"""

from pathlib import Path

import numpy as np

from .....base.errors import InputError
from ...reading.frames import NED
from ...reading.poses import Poses
from ...reading.rotations import rotations_of
from ...text_lines import data_lines, parse_numbers
from ...trace_format import TraceFormat, refuse_selector

_NAMES = ("TimeStamp", "POS_X", "POS_Y", "POS_Z", "Q_W", "Q_X", "Q_Y", "Q_Z")


def read_airsim(path: Path, selector: str | None = None) -> Poses:
    """Return the poses; raises `InputError` if a column is missing or a number broken."""
    refuse_selector(selector, path, "AirSim")
    numbered = data_lines(path)
    first, text = next(numbered, (1, ""))
    header = text.split("\t")
    missing = [name for name in _NAMES if name not in header]
    if missing:
        message = f"expected a column {missing[0]}, got {', '.join(header)[:80]}; name the format"
        raise InputError(message, path=path, line=first)
    at = [header.index(name) for name in _NAMES]
    lines: list[int] = []
    rows: list[list[float]] = []
    for line, text in numbered:
        fields = text.split("\t")
        if len(fields) <= max(at):
            message = f"expected {len(header)} columns, got {len(fields)}; complete the row"
            raise InputError(message, path=path, line=line)
        rows.append(parse_numbers([fields[k] for k in at], _NAMES, path=path, line=line))
        lines.append(line)
    table = np.array(rows).reshape(-1, len(_NAMES))
    return Poses(
        name=path.stem,
        lines=lines,
        time=table[:, 0],
        time_unit="ms",
        position=table[:, 1:4],
        rotation=rotations_of(table[:, [5, 6, 7, 4]], path, lines),
        frame=NED,
    )


def _recognises(head: list[str]) -> bool:
    return bool(head) and head[0].startswith("TimeStamp\t") and "POS_X" in head[0]


FORMAT = TraceFormat("airsim_rec.txt of AirSim", _recognises, read_airsim)
