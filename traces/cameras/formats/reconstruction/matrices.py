"""Rows of 16 numbers, 4 x 4 matrices row by row, without times (Replica, MonoGS).

Each takes an OpenCV camera to a world of which the file says nothing; y down is taken, as in the
optical frame of the first camera.
"""

from pathlib import Path

from ...reading.frames import OPENCV
from ...reading.poses import Poses
from ...reading.rotations import nearest_rotations
from ...text_lines import data_lines, first_data, read_rows
from ...trace_format import TraceFormat, refuse_selector

_NAMES = tuple(f"m{row}{column}" for row in range(4) for column in range(4))


def read_matrices(path: Path, selector: str | None = None) -> Poses:
    """Return the poses; raises `InputError` for a row that is no 4 x 4 pose."""
    refuse_selector(selector, path, "file of 4 x 4 matrices")
    lines, table = read_rows(data_lines(path), _NAMES, path)
    matrices = table.reshape(-1, 4, 4)
    rotation, repairs = nearest_rotations(matrices[:, :3, :3], path, lines)
    return Poses(
        name=path.stem,
        lines=lines,
        time=None,
        position=matrices[:, :3, 3],
        rotation=rotation,
        frame=OPENCV,
        unit=None,
        repairs=repairs,
    )


def _recognises(head: list[str]) -> bool:
    first = first_data(head)
    return len(first.split()) == len(_NAMES) and "," not in first


FORMAT = TraceFormat("4 x 4 matrices, one a line, without times", _recognises, read_matrices)
