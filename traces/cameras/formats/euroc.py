"""EuRoC MAV ground truth: CSV with nanoseconds, position, and quaternion w first.

The format is that of Burri et al., "The EuRoC micro aerial vehicle datasets", IJRR 2016. The
world frame R has z up. The pose is that of the body frame S, which is the IMU's: x up, y right,
z ahead. The camera of the trace looks along the body's z with the body's x up; this is the left
camera of the vehicle (``T_BS`` of ``cam0`` in the data set) to within 1.8 degrees, and its
6.9 cm off the IMU are left out.
"""

from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..camera_trace import CameraTrace
from ..samples import trace_from_samples
from ..text_lines import data_lines, first_data, parse_numbers
from ..trace_format import TraceFormat, refuse_selector

COLUMNS = ("p_x", "p_y", "p_z", "q_w", "q_x", "q_y", "q_z")


def read_euroc(path: Path, selector: str | None = None) -> CameraTrace:
    """Camera trace of a EuRoC ground-truth file; columns after the quaternion are not read.

    Raises `InputError` if a row has fewer than 8 columns, a timestamp that is not a whole number of
    nanoseconds, or a number that is not finite; or as `trace_from_samples`.
    """
    refuse_selector(selector, path, "EuRoC")
    lines: list[int] = []
    stamps_ns: list[int] = []
    rows: list[list[float]] = []
    for line, text in data_lines(path):
        fields = text.split(",")
        stamps_ns.append(_nanoseconds(fields[0], path, line))
        rows.append(parse_numbers(fields[1:8], COLUMNS, path=path, line=line))
        lines.append(line)
    table = np.array(rows).reshape(-1, len(COLUMNS))
    first_ns = stamps_ns[0] if stamps_ns else 0
    return trace_from_samples(
        path.stem,
        path,
        lines,
        time_s=[(stamp - first_ns) / 1e9 for stamp in stamps_ns],
        position_m=table[:, 0:3],
        orientation_xyzw=_camera_from_body(table[:, [4, 5, 6, 3]]),
        origin_s=first_ns / 1e9,
    )


def _nanoseconds(field: str, path: Path, line: int) -> int:
    text = field.strip()
    if not (text.isascii() and text.isdigit() and len(text) <= 19):
        message = (
            f"expected a timestamp in whole nanoseconds, got {text[:40]!r}; "
            "correct or remove the row"
        )
        raise InputError(message, path=path, line=line)
    return int(text)


def _camera_from_body(orientation_xyzw: FloatArray) -> FloatArray:
    # Camera right, up and back are the body's y, x and -z: half a turn about the bisector of
    # the body's x and y, the quaternion (1, 1, 0, 0) / sqrt(2) on the right.
    x, y, z, w = np.moveaxis(orientation_xyzw, -1, 0) * np.sqrt(0.5)
    with np.errstate(over="ignore"):  # what overflows is no unit quaternion and is refused later
        return np.stack([w - z, w + z, x - y, -x - y], axis=-1)


def _recognises(head: list[str]) -> bool:
    if head and head[0].startswith("#timestamp") and "," in head[0]:
        return True
    stamp, *numbers = first_data(head).split(",")
    return len(numbers) >= 7 and stamp.isdigit() and len(stamp) > 15


FORMAT = TraceFormat(
    "EuRoC MAV ground truth: nanoseconds, position, qw qx qy qz", _recognises, read_euroc
)
