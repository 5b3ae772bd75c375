"""From the samples of a file to a camera trace: what is mended, counted, or refused.

==============================  ===============================================================
repeated timestamp              within a nanosecond: the later sample is dropped, counted
backward timestamp              refused
median interval over 60 s       refused: the times are not in seconds
time beyond 30,000 years        refused likewise
gap of more than an hour        refused, as is a path of more than 48 hours
coordinate beyond 10,000 km     refused: the positions are not in metres
norm of quaternion off 1 by     up to 0.001: rounding of printed digits, divided by the norm;
                                up to 0.1: the same, counted; more: refused
==============================  ===============================================================
"""

from collections.abc import Sequence
from math import hypot
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import BoolArray, FloatArray, refuse_rows
from ...base.errors import InputError
from .camera_trace import CameraTrace, Repair, first_too_late, why_too_late

MIN_INTERVAL_S = 1e-9
MAX_INTERVAL_S = 60.0
MAX_TIME_S = 1e12
MAX_COORDINATE_M = 1e7
ROUNDING = 1e-3
MAX_NORM_ERROR = 0.1
_SECONDS = "convert nanoseconds or milliseconds to seconds, or name the right format"


def trace_from_samples(
    name: str,
    path: Path,
    lines: Sequence[int],
    *,
    time_s: ArrayLike,
    position_m: ArrayLike,
    orientation_xyzw: ArrayLike,
    cut: Sequence[bool] | BoolArray | None = None,
    origin_s: float = 0.0,
    repairs: tuple[Repair, ...] = (),
) -> CameraTrace:
    """Trace from n finite samples in the scene frame, mended where that is safe.

    Parameters
    ----------
    lines
        (n,) 1-based line of each sample in the file, for errors.
    time_s
        (n,) in file order; the first is added to ``origin_s`` and subtracted from all.
    cut
        (n,) as in `CameraTrace`; that of the first sample is ignored. None: no cuts.
    repairs
        What was mended before.

    Raises
    ------
    InputError
        With the file's line, for what the table of this module refuses.
    """
    if not lines:
        raise InputError("expected at least one sample, got none; is the file cut off?", path=path)
    times = np.asarray(time_s, dtype=np.float64)
    positions = np.asarray(position_m, dtype=np.float64)
    kept = _kept_samples(times, path, lines)
    _check_units(times[kept], positions, path, lines)
    if (at := first_too_late(times[kept])) is not None:
        advice = "cut the file there, or correct its times"
        message = f"{why_too_late(times[kept], at)}; {advice}"
        raise InputError(message, path=path, line=lines[int(kept[at])])
    orientations, renormalised = _unit(np.asarray(orientation_xyzw, dtype=np.float64), path, lines)
    cuts = np.zeros(len(lines), dtype=np.bool_) if cut is None else np.asarray(cut, dtype=np.bool_)
    # A dropped sample hands its cut to the next one that is kept.
    cuts = np.logical_or.reduceat(cuts, np.append(0, kept[:-1] + 1))
    cuts[0] = False
    counted = (
        Repair(len(lines) - len(kept), "repeated timestamps dropped"),
        Repair(renormalised, "quaternions renormalised"),
    )
    return CameraTrace(
        name.encode("utf-8", "replace").decode(),  # a file's name may be no Unicode text
        times[kept] - times[0],
        positions[kept],
        orientations[kept],
        cuts,
        origin_s=origin_s + float(times[0]),
        repairs=repairs + tuple(repair for repair in counted if repair.count),
    )


def _kept_samples(times: FloatArray, path: Path, lines: Sequence[int]) -> NDArray[np.intp]:
    refuse_rows(
        np.abs(times) > MAX_TIME_S,
        lambda row: f"expected times in seconds, got {times[row]:.9g}; {_SECONDS}",
        path=path,
        lines=lines,
    )
    steps = np.diff(times)
    refuse_rows(
        np.append(False, steps < 0.0),
        lambda row: (
            f"expected times in order, got {times[row]:.15g} after {times[row - 1]:.15g}; "
            "sort the samples, or cut the file where the clock was set back"
        ),
        path=path,
        lines=lines,
    )
    return np.flatnonzero(np.append(True, steps > MIN_INTERVAL_S))


def _check_units(
    times: FloatArray, positions: FloatArray, path: Path, lines: Sequence[int]
) -> None:
    interval_s = float(np.median(np.diff(times))) if len(times) > 1 else 0.0
    if interval_s > MAX_INTERVAL_S:
        message = f"expected times in seconds, got {interval_s:.3g} between samples; {_SECONDS}"
        raise InputError(message, path=path)
    farthest = np.abs(positions).max(axis=1)
    refuse_rows(
        farthest > MAX_COORDINATE_M,
        lambda row: (
            f"expected positions in metres within {MAX_COORDINATE_M:.0e}, "
            f"got {farthest[row]:.3g}; subtract an origin or convert the unit"
        ),
        path=path,
        lines=lines,
    )


def _unit(quaternions: FloatArray, path: Path, lines: Sequence[int]) -> tuple[FloatArray, int]:
    # What is clipped is refused, and must not overflow.
    norm: FloatArray = np.linalg.norm(np.clip(quaternions, -2.0, 2.0), axis=1)
    error: FloatArray = np.abs(norm - 1.0)
    refuse_rows(
        error > MAX_NORM_ERROR,
        lambda row: (
            f"expected a unit quaternion, got one of norm {hypot(*quaternions[row]):.6g}; "
            "check the order of the columns"
        ),
        path=path,
        lines=lines,
    )
    # What is unit to the last bit stays as it is, so that writing and reading change nothing.
    norm[error < 1e-15] = 1.0
    return quaternions / norm[:, np.newaxis], int(np.sum(error > ROUNDING))
