"""Poses as a file has them, and the camera trace that they make."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..camera_trace import CameraTrace, Repair
from ..samples import trace_from_samples
from .frames import Frame, parse_frame
from .units import TIME_UNITS_S, UNITS_M, guess_time_unit, require_unit

_RATES_HZ = 0.01, 100_000.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """What a user says about a file, in place of what its format says; None where nothing.

    Attributes
    ----------
    frame : str or None
        As `parse_frame` takes it.
    unit, time_unit : str or None
        Of lengths and times.
    rate_hz : float or None
        Poses a second, where there are no times.
    columns : dict of str to str
        Column of the file by role, for tables.
    """

    frame: str | None = None
    unit: str | None = None
    time_unit: str | None = None
    rate_hz: float | None = None
    columns: Mapping[str, str] = field(default_factory=dict[str, str])

    def __post_init__(self) -> None:
        if self.unit is not None:
            require_unit(self.unit, UNITS_M, "unit")
        if self.time_unit is not None:
            require_unit(self.time_unit, TIME_UNITS_S, "time-unit")
        if self.rate_hz is not None and not _RATES_HZ[0] <= self.rate_hz <= _RATES_HZ[1]:
            raise InputError(f"rate: expected 0.01 to 100,000 poses a second, got {self.rate_hz:g}")


AS_FOUND = Reading()


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Poses:
    """What a reader found.

    Attributes
    ----------
    name : str
    lines : sequence of int
        1-based line or record of each pose.
    time : (n,) or None
        In the file's unit; None where the file has none.
    time_unit : str or None
        None if the format does not say.
    position : (n, 3)
        In the file's axes and unit.
    rotation : (n, 3, 3)
        Columns are the camera's axes, in the file's world; or the inverse, as `frame` says.
    frame : Frame
        That of the format.
    unit : str or None
        None where lengths are unscaled, as those of reconstructions.
    rate_hz : float or None
        That the file states, where it has no times.
    fovy_deg : float or None
        That the file states.
    repairs : tuple of Repair
    assumed : tuple of str
        What the reader took for granted, in words.
    """

    name: str
    lines: Sequence[int]
    time: FloatArray | None
    time_unit: str | None = None
    position: FloatArray
    rotation: FloatArray
    frame: Frame
    unit: str | None = "m"
    rate_hz: float | None = None
    fovy_deg: float | None = None
    repairs: tuple[Repair, ...] = ()
    assumed: tuple[str, ...] = ()


def trace_of_poses(poses: Poses, path: Path, reading: Reading = AS_FOUND) -> CameraTrace:
    """Return the trace of a file's poses.

    Raises `InputError` if the file has no times and nobody says at which rate, or as
    `trace_from_samples` and `Frame.to_scene`.
    """
    from scipy.spatial.transform import Rotation

    if not len(poses.lines):
        raise InputError("expected at least one pose, got none; is the file cut off?", path=path)
    frame = poses.frame if reading.frame is None else parse_frame(reading.frame, poses.frame)
    assumed = list(poses.assumed)
    if reading.frame is None:
        assumed.append(str(frame))
    position, rotation = frame.to_scene(poses.position, poses.rotation)
    unit = reading.unit or poses.unit
    if unit is None:
        assumed.append("lengths, which the format leaves unscaled, in metres")
    time_s, origin_s, clock = _times(poses, path, reading)
    assumed += clock
    quaternions: FloatArray = Rotation.from_matrix(rotation).as_quat()
    trace = trace_from_samples(
        poses.name,
        path,
        poses.lines,
        time_s=time_s,
        position_m=position * UNITS_M[unit or "m"],
        orientation_xyzw=quaternions,
        origin_s=origin_s,
        repairs=poses.repairs,
    )
    return replace(trace, assumed=tuple(assumed), fovy_deg=poses.fovy_deg)


def _times(poses: Poses, path: Path, reading: Reading) -> tuple[FloatArray, float, list[str]]:
    """Return times from 0 on, the clock's first reading in seconds, and what was assumed."""
    unit = reading.time_unit or poses.time_unit
    said: list[str] = []
    if poses.time is not None and unit is None and reading.rate_hz is None:
        unit = guess_time_unit(poses.time)
        said = [] if unit is None else [f"times in {unit}"]
    if poses.time is not None and reading.rate_hz is not None:
        _require_counts(poses, unit, path)
    rate_hz = reading.rate_hz or poses.rate_hz
    if poses.time is not None and unit is not None and reading.rate_hz is None:
        scale_s = TIME_UNITS_S[unit]
        first = float(poses.time[0])  # subtracted first: nanoseconds since 1970 need all digits
        return (poses.time - first) * scale_s, first * scale_s, said
    if rate_hz is None:
        missing = "no times" if poses.time is None else "numbers that fit no unit of time"
        raise InputError(
            f"expected times of the poses, got {missing}; say how many there are a second, as in "
            "`lodbench trace convert FILE OUT.csv --rate 30`",
            path=path,
        )
    if poses.time is None:
        return np.arange(len(poses.lines)) / rate_hz, 0.0, []
    counted = poses.time - poses.time[0]
    return counted / rate_hz, 0.0, [f"times are numbers of frames, {rate_hz:g} a second"]


def _require_counts(poses: Poses, unit: str | None, path: Path) -> None:
    """Raise `InputError` if a rate is given for times: only numbers of frames are divided by it."""
    assert poses.time is not None
    if unit is None and np.all(poses.time == np.round(poses.time)):
        return
    got = "times" if unit is None else f"times in {unit}"
    raise InputError(
        f"rate: expected a file without times, got {got}; leave the rate out, or say --time-unit",
        path=path,
    )
