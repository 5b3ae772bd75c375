"""Headset paths recorded in Unity, several people and sequences in one CSV.

Columns ``HMDPX HMDPY HMDPZ`` (metres), ``HMDRX HMDRY HMDRZ`` (degrees), ``Participant``,
``Dataset`` (the sequence that was watched) and ``ViewFrame`` (30 per second), as recorded by
Subramanyam et al., "User centered adaptive streaming of dynamic point clouds with low complexity
tiling", ACM Multimedia 2020, doi 10.1145/3394171.3413535. There are no timestamps.

Unity's world is left-handed: x right, y up, z ahead; its Euler angles turn about z, then x, then
y, so R_u = Ry Rx Rz, and since Unity's handedness is in its axes, not in its formulas, the three
are the usual matrices. The mirror S that swaps y and z makes the world right-handed with z up:
a point p_u becomes S p_u, and a rotation S R_u S. A head that Unity does not turn looks along
its z with y up, after S along y with z up; the camera frame used here gets there by a quarter
turn about x, C = Rx(90 deg). So R = S R_u S C. On quaternions S R_u S is
``(-x, -z, -y, w)``, because a mirror also turns the sense of rotation.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..camera_trace import CameraTrace
from ..samples import trace_from_samples
from ..text_lines import data_lines, parse_numbers
from ..trace_format import TraceFormat

RATE_HZ = 30.0
NUMBERS = ("ViewFrame", "HMDPX", "HMDPY", "HMDPZ", "HMDRX", "HMDRY", "HMDRZ")
KEYS = ("Participant", "Dataset")


def read_headset(path: Path, selector: str | None = None) -> CameraTrace:
    """Path of one participant through one sequence.

    ``selector`` is ``PARTICIPANT``, ``PARTICIPANT/SEQUENCE`` or ``first``; None will do when the
    file holds only one path.

    Raises `InputError` if the selector fits no path or several, a column is missing, or a row of
    any participant is broken; or as `trace_from_samples`.
    """
    lines: dict[str, list[int]] = {}
    rows: dict[str, list[list[float]]] = {}
    for line, key, numbers in _rows(path):
        lines.setdefault(key, []).append(line)
        rows.setdefault(key, []).append(numbers)
    chosen = _choose(list(rows), selector, path)
    table = np.array(rows[chosen])
    return trace_from_samples(
        f"{path.stem}#{chosen}",
        path,
        lines[chosen],
        time_s=table[:, 0] / RATE_HZ,
        position_m=table[:, [1, 3, 2]],
        orientation_xyzw=_camera_from_unity(table[:, 4:7]),
    )


def _rows(path: Path) -> Iterator[tuple[int, str, list[float]]]:
    """Line, participant/sequence, and numbers of each row."""
    numbered = data_lines(path)
    first, text = next(numbered, (1, ""))
    header = [name.strip() for name in text.split(",")]
    columns = [_column(header, name, path, first) for name in (*NUMBERS, *KEYS)]
    for line, text in numbered:
        fields = text.split(",")
        if len(fields) != len(header):
            message = (
                f"expected {len(header)} columns as in the header, got {len(fields)}; "
                "complete or remove the row"
            )
            raise InputError(message, path=path, line=line)
        *numbers, participant, sequence = (fields[column].strip() for column in columns)
        values = parse_numbers(numbers, NUMBERS, path=path, line=line)
        yield line, f"{participant}/{sequence}", values


def _column(header: list[str], name: str, path: Path, line: int) -> int:
    if header.count(name) != 1:
        message = f"expected one column {name}, got {header.count(name)}; name the right format"
        raise InputError(message, path=path, line=line)
    return header.index(name)


def _choose(keys: list[str], selector: str | None, path: Path) -> str:
    if not keys:
        raise InputError("expected at least one sample, got only a header", path=path)
    if selector == "first":
        return keys[0]
    fitting = [key for key in keys if selector in {None, key, key.partition("/")[0]}]
    if len(fitting) == 1:
        return fitting[0]
    choices = fitting or keys
    shown = ", ".join(choices[:6]) + (f", … ({len(choices)} in all)" if len(choices) > 6 else "")
    got = "no choice" if selector is None else f"#{selector}, which fits {len(fitting)} of them"
    message = (
        f"expected a choice of one of {shown}, got {got}; "
        f"name it after #, as in {path.name}#{choices[0]}, or take {path.name}#first"
    )
    raise InputError(message, path=path)


def _camera_from_unity(euler_deg: FloatArray) -> FloatArray:
    from scipy.spatial.transform import Rotation

    unity: FloatArray = Rotation.from_euler("YXZ", euler_deg[:, [1, 0, 2]], degrees=True).as_quat()
    x, y, z, w = unity.T
    mirrored = Rotation.from_quat(np.column_stack([-x, -z, -y, w]))
    camera: FloatArray = (mirrored * Rotation.from_euler("X", 90.0, degrees=True)).as_quat()
    return camera


def _recognises(head: list[str]) -> bool:
    return bool(head) and "HMDPX" in head[0] and "," in head[0]


FORMAT = TraceFormat(
    "Unity headset CSV; choose FILE#PARTICIPANT or FILE#PARTICIPANT/SEQUENCE",
    _recognises,
    read_headset,
)
