"""Open3D's trajectories, without times: `.log`, camera to world, and `.json`, world to camera.

Zhou, Park and Koltun, "Open3D: a modern library for 3D data processing", arXiv:1801.09847.  A
record of the log is a line of three whole numbers and four rows; the JSON has 16 numbers a pose,
column by column.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .....base.arrays import FloatArray
from .....base.errors import InputError
from .....base.files.strict_json import read_json
from ...reading.frames import Frame
from ...reading.poses import Poses
from ...reading.rotations import nearest_rotations
from ...text_lines import data_lines, first_data, parse_numbers
from ...trace_format import TraceFormat, refuse_selector

_ROW = ("x", "y", "z", "t")
_ADVICE = "give the file as Open3D wrote it"


@dataclass
class _Parameters:
    extrinsic: list[float]


@dataclass
class _Trajectory:
    parameters: list[_Parameters]


def read_open3d_log(path: Path, selector: str | None = None) -> Poses:
    """Return the poses of a `.log`; raises `InputError` for a record that is not whole."""
    refuse_selector(selector, path, "Open3D")
    numbered = list(data_lines(path))
    if len(numbered) % 5:
        message = f"expected records of 5 lines, got {len(numbered)} lines; is the file cut off?"
        raise InputError(message, path=path)
    lines = [line for line, _ in numbered[::5]]
    rows = [
        parse_numbers(text.split(), _ROW, path=path, line=line)
        for at, (line, text) in enumerate(numbered)
        if at % 5
    ]
    return _poses(path, lines, np.array(rows).reshape(-1, 4, 4), Frame("opencv", "-y"))


def read_open3d_json(path: Path, selector: str | None = None) -> Poses:
    """Return the poses of a trajectory; raises `InputError` for one without 16 numbers."""
    refuse_selector(selector, path, "Open3D")
    poses = read_json(path, _Trajectory, "a trajectory of Open3D", _ADVICE).parameters
    for at, one in enumerate(poses):
        if (found := len(one.extrinsic)) != 16:
            message = f"parameters[{at}].extrinsic: expected 16 numbers, got {found}; {_ADVICE}"
            raise InputError(message, path=path)
    columns = np.array([one.extrinsic for one in poses], dtype=np.float64).reshape(-1, 4, 4)
    lines = range(1, len(poses) + 1)
    frame = Frame("opencv", "-y", inverse=True)
    return _poses(path, list(lines), np.swapaxes(columns, 1, 2), frame)


def _poses(path: Path, lines: list[int], matrices: FloatArray, frame: Frame) -> Poses:
    rotation, repairs = nearest_rotations(matrices[:, :3, :3], path, lines)
    return Poses(
        name=path.stem,
        lines=lines,
        time=None,
        position=matrices[:, :3, 3],
        rotation=rotation,
        frame=frame,
        repairs=repairs,
    )


def _recognises_log(head: list[str]) -> bool:
    counts = [len(line.split()) for line in head[:5]]
    return counts == [3, 4, 4, 4, 4] and all(map(str.isdigit, first_data(head).split()))


def _recognises_json(head: list[str]) -> bool:
    text = " ".join(head)
    return '"extrinsic"' in text and '"parameters"' in text


FORMAT = TraceFormat("Open3D .log, without times", _recognises_log, read_open3d_log)
JSON = TraceFormat("Open3D trajectory .json, without times", _recognises_json, read_open3d_json)
