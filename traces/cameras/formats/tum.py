"""TUM RGB-D trajectories: ``timestamp tx ty tz qx qy qz qw``, seconds and metres.

The format is that of Sturm et al., "A benchmark for the evaluation of RGB-D SLAM systems",
IROS 2012. The world frame has z up. The pose is that of the colour camera's optical frame, which
looks along +z with x right and y down; half a turn about x makes it the camera frame used here.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from ....base.errors import InputError
from ..camera_trace import CameraTrace
from ..orientation import camera_from_optical, optical_from_camera
from ..samples import trace_from_samples
from ..text_lines import data_lines, first_data, read_rows
from ..trace_format import TraceFormat, refuse_selector

_NANOSECONDS = 1e17
"""Clock times above are not in seconds: ORB-SLAM3 writes nanoseconds where it was fed with them."""

COLUMNS = ("timestamp", "tx", "ty", "tz", "qx", "qy", "qz", "qw")


def read_tum(path: Path, selector: str | None = None) -> CameraTrace:
    """Camera trace of a TUM file.

    Raises `InputError` if a row has not 8 finite numbers, or as `trace_from_samples`.
    """
    refuse_selector(selector, path, "TUM")
    lines, table = read_rows(data_lines(path), COLUMNS, path)
    time_s, first_s, assumed = table[:, 0], 0.0, ()
    if len(table) and table[0, 0] > _NANOSECONDS:
        # Subtracted first, since nanoseconds since 1970 fill all digits of a number.
        time_s, first_s = (time_s - time_s[0]) * 1e-9, float(time_s[0]) * 1e-9
        assumed = ("times in ns",)
    trace = trace_from_samples(
        path.stem,
        path,
        lines,
        time_s=time_s,
        position_m=table[:, 1:4],
        orientation_xyzw=camera_from_optical(table[:, 4:8]),
        origin_s=first_s,
    )
    return replace(trace, assumed=assumed)


def write_tum(trace: CameraTrace, path: Path) -> None:
    """Write a trace for tools that read TUM files; times include ``origin_s``.

    Raises `InputError` if the trace has cuts, which the format cannot hold.
    """
    if trace.cut.any():
        message = (
            f"expected a trace without cuts for TUM, got {trace.cut.sum()} cuts; "
            "write csv or parquet"
        )
        raise InputError(message, path=path)
    optical = optical_from_camera(trace.orientation_xyzw)
    table = np.column_stack([trace.origin_s + trace.time_s, trace.position_m, optical])
    rows = (" ".join(map(repr, row)) for row in table.tolist())
    path.write_text("\n".join([f"# {' '.join(COLUMNS)}", *rows, ""]), encoding="utf-8")


def _recognises(head: list[str]) -> bool:
    fields = first_data(head).split()
    return len(fields) == len(COLUMNS) and fields[0][-1:].isdigit() and "," not in fields[0]


FORMAT = TraceFormat(
    "TUM RGB-D: timestamp tx ty tz qx qy qz qw",
    _recognises,
    read_tum,
    write_tum,
    (".txt", ".tum"),
)
