"""KITTI odometry: 12 numbers of a 3 x 4 matrix a line, and a second file with the times.

The format is that of Geiger, Lenz and Urtasun, "Are we ready for autonomous driving? The KITTI
vision benchmark suite", CVPR 2012. The world frame is the optical frame of the first camera:
x right, y down, z ahead; it becomes x right, y ahead, z up, which takes the first camera to be
level. The pose is that of the optical frame of each camera.
"""

from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..camera_trace import CameraTrace
from ..orientation import camera_from_optical
from ..reading.rotations import nearest_rotations
from ..samples import trace_from_samples
from ..text_lines import data_lines, first_data, read_rows
from ..trace_format import TraceFormat

COLUMNS = tuple(f"m{row}{column}" for row in range(3) for column in range(4))
Z_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])


def read_kitti(path: Path, selector: str | None = None) -> CameraTrace:
    """Camera trace of a KITTI poses file.

    ``selector`` names the file with the times, relative to the poses' folder; without it
    ``NAME-times.txt`` or ``times.txt`` beside the poses is read.

    Raises `InputError` if a row has not 12 finite numbers, a matrix is no rotation, or there are no
    times or not as many as poses; or as `trace_from_samples`.
    """
    lines, table = read_rows(data_lines(path), COLUMNS, path)
    matrices = table.reshape(-1, 3, 4)
    rotations, repairs = nearest_rotations(matrices[:, :, :3], path, lines)
    from scipy.spatial.transform import Rotation

    orientation: FloatArray = Rotation.from_matrix(Z_UP @ rotations).as_quat()
    return trace_from_samples(
        path.stem,
        path,
        lines,
        time_s=_read_times(_times_path(path, selector), path, len(lines)),
        position_m=matrices[:, :, 3] @ Z_UP.T,
        orientation_xyzw=camera_from_optical(orientation),
        repairs=repairs,
    )


def _times_path(path: Path, selector: str | None) -> Path:
    if selector is not None:
        return path.parent / selector
    candidates = [path.with_name(f"{path.stem}-times.txt"), path.with_name("times.txt")]
    for candidate in candidates:
        if candidate.is_file():
            return candidate
    names = " or ".join(candidate.name for candidate in candidates)
    message = (
        f"expected the times of the poses in {names} beside it, got neither; "
        f"name the file after #, as in {path.name}#FILE"
    )
    raise InputError(message, path=path)


def _read_times(path: Path, poses: Path, count: int) -> FloatArray:
    times = read_rows(data_lines(path), ("time",), path)[1][:, 0]
    if len(times) != count:
        message = (
            f"expected {count} times, one for each pose of {poses.name}, got {len(times)}; "
            "give the file that belongs to it"
        )
        raise InputError(message, path=path)
    return times


def _recognises(head: list[str]) -> bool:
    first = first_data(head)
    return len(first.split()) == len(COLUMNS) and "," not in first


FORMAT = TraceFormat(
    "KITTI odometry poses, with their times in a second file",
    _recognises,
    read_kitti,
)
