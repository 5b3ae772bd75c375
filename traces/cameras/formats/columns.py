"""Tables of any tool whose columns have names: time, position, and some form of orientation.

Orientations are quaternions, yaw-pitch-roll, Euler angles about x, y and z as Unity applies them
(z, then x, then y), or directions ahead and up.  Axes that the file does not state are assumed, and
said; `--frame`, `--unit` and `--map` say otherwise.
"""

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..camera_trace import Repair
from ..reading.column_roles import EULER, QUATERNION, YAW, find_roles
from ..reading.frames import OPENGL, Frame
from ..reading.poses import AS_FOUND, Poses, Reading
from ..reading.rotations import rotations_along, rotations_of
from ..text_lines import read_lines
from ..trace_format import TraceFormat, refuse_selector

_AHEAD = ("forward_x", "forward_y", "forward_z")
_TUM = {"tx", "ty", "tz", "qx", "qy", "qz", "qw"}
"""Names of columns in files that follow TUM's convention: an optical frame, z up."""
_UP = ("up_x", "up_y", "up_z")


def read_columns(path: Path, selector: str | None = None, reading: Reading = AS_FOUND) -> Poses:
    """Return the poses; raises `InputError` if a column is missing or its role is not clear."""
    refuse_selector(selector, path, "table")
    start, header, rows = _table(path)
    roles = find_roles(header, reading.columns, path, start)
    names = list(roles)
    lines: list[int] = []
    found: list[list[float]] = []
    left_out = 0
    for line, row in rows:
        try:
            numbers = [float(row[roles[name].index]) for name in names]
        except (ValueError, IndexError):
            numbers = [math.nan]
        if all(map(math.isfinite, numbers)):
            lines.append(line)
            found.append(numbers)
        else:
            left_out += 1
    table = dict(zip(names, np.array(found).reshape(-1, len(names)).T, strict=True))
    repairs = (Repair(left_out, "rows without numbers left out"),) if left_out else ()
    if left_out > len(lines):
        message = f"expected rows of numbers, got {left_out} of {left_out + len(lines)} without"
        raise InputError(f"{message}; check the columns with --map", path=path)
    frame, rotation, said = _rotation(table, path, lines)
    if {name.lower() for name in header} >= _TUM:
        frame, said = Frame("opencv", "z"), ()
    time = table.get("time", table.get("frame"))
    return Poses(
        name=path.stem,
        lines=lines,
        time=time,
        time_unit=roles["time"].unit if "time" in roles else None,
        position=np.stack([table[axis] for axis in "xyz"], axis=1),
        rotation=rotation,
        frame=frame,
        unit=roles["x"].unit or "m",
        repairs=repairs,
        assumed=said,
    )


def _rotation(
    table: Mapping[str, FloatArray], path: Path, lines: Sequence[int]
) -> tuple[Frame, FloatArray, tuple[str, ...]]:
    """Return the usual frame of such orientations, the rotations, and what was assumed."""
    from scipy.spatial.transform import Rotation

    def take(names: Sequence[str]) -> FloatArray:
        return np.stack([table[name] for name in names], axis=1)

    if QUATERNION[0] in table:
        return OPENGL, rotations_of(take(QUATERNION), path, lines), ()
    if _AHEAD[0] in table:
        up = take(_UP) if _UP[0] in table else np.tile((0.0, 0.0, 1.0), (len(lines), 1))
        turned = rotations_along(take(_AHEAD), up, path, lines, left_handed=False)
        return Frame("opengl", "z"), turned, ()
    if YAW[0] in table:
        yaw, pitch = np.radians(table["yaw"]), np.radians(table.get("pitch", 0.0 * table["yaw"]))
        roll = np.radians(table.get("roll", 0.0 * table["yaw"]))
        said = "yaw counter-clockwise from x about z, pitch up, roll to the right, in degrees"
        return Frame("opengl", "z"), _turned(yaw, pitch, roll, path, lines), (said,)
    turns = Rotation.from_euler("YXZ", take(EULER)[:, [1, 0, 2]], degrees=True)
    said = "Euler angles in degrees, about z, then x, then y"
    return Frame("unity", "y", left_handed=True), turns.as_matrix(), (said,)


def _turned(
    yaw: FloatArray, pitch: FloatArray, roll: FloatArray, path: Path, lines: Sequence[int]
) -> FloatArray:
    ahead = np.stack(
        (np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), np.sin(pitch)), axis=1
    )
    right = np.stack((np.sin(yaw), -np.cos(yaw), 0.0 * yaw), axis=1)
    level_up = np.cross(right, ahead)
    up = np.cos(roll)[:, np.newaxis] * level_up + np.sin(roll)[:, np.newaxis] * right
    return rotations_along(ahead, up, path, lines, left_handed=False)


def _table(path: Path) -> tuple[int, list[str], list[tuple[int, list[str]]]]:
    """Return the header's line, its names, and the numbered rows below."""
    lines = read_lines(path)
    first = next((n for n, text in enumerate(lines) if _names(text)), None)
    if first is None:
        raise InputError("expected a header with names of columns, got none", path=path)
    delimiter = _delimiter(lines[first])
    rows = list(csv.reader(lines[first:], delimiter=delimiter, skipinitialspace=True))
    header = [name.strip().lstrip("#").strip() for name in rows[0]]
    numbered = [(first + 1 + n, row) for n, row in enumerate(rows[1:], start=1) if any(row)]
    return first + 1, header, numbered


def _names(text: str) -> bool:
    """Whether a line is a header: several fields, none of them a number."""
    fields = [field.strip() for field in text.lstrip("# ").split(_delimiter(text))]
    if len(fields) < 4:
        return False
    return sum(not _is_number(field) for field in fields) >= len(fields) - 1


def _delimiter(text: str) -> str:
    return max(",;\t ", key=text.count)


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _recognises(head: list[str]) -> bool:
    for text in head[:5]:
        if _names(text):
            names = [name.strip() for name in text.lstrip("# ").split(_delimiter(text))]
            try:
                find_roles(names, {}, Path(), 1)
            except InputError:
                return False
            return True
    return False


FORMAT = TraceFormat(
    "table with named columns of time, position and turn", _recognises, read_columns
)
