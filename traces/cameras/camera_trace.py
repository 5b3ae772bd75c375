"""Camera traces: where the camera was and how it was turned, at any time.

Conventions, the same for every trace whatever file it came from:

- the scene frame is right-handed with z up; lengths are metres, times seconds;
- the camera looks along -z of its own frame, +x is right and +y is up (as in OpenGL and glTF);
- an orientation is a unit quaternion ``x y z w`` that turns vectors of the camera frame into the
  scene frame;
- time starts at 0; ``origin_s`` keeps the time that the source gave to the first sample.

Between samples the position is interpolated linearly and the orientation by slerp along the
shorter arc (Shoemake, "Animating rotation with quaternion curves", SIGGRAPH 1985); before the
first and after the last sample the pose is held.
"""

import math
from bisect import bisect_right
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ...base.arrays import BoolArray, FloatArray, frozen_array, require_finite
from ...base.errors import InputError

# Above this cosine of half the turn (1.6 thousandths of a degree) slerp and lerp agree to the
# last bit, and the sine in slerp's denominator would lose digits.
_NEARLY_EQUAL = 1.0 - 1e-10

MAX_GAP_S = 3600.0
"""Time between two poses: more is a clock that was set, or two recordings in one file."""

MAX_LENGTH_S = 48.0 * 3600.0
"""Time from the first pose to the last."""


class Pose(NamedTuple):
    """A camera's position and its orientation, a unit quaternion ``x y z w``."""

    position_m: tuple[float, float, float]
    orientation_xyzw: tuple[float, float, float, float]


@dataclass(frozen=True, slots=True)
class Repair:
    """One kind of repair that a reader made, and to how many samples."""

    count: int
    what: str

    def __str__(self) -> str:
        return f"{self.count} {self.what}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class CameraTrace:
    """A camera path as samples over time, with the pose at any time in between.

    Raises `InputError` if an array has the wrong shape, holds NaN or infinity, or breaks a rule
    above.

    Parameters
    ----------
    name
        What tables call it.
    time_s
        (n,), n >= 1, strictly increasing from 0, by at most `MAX_GAP_S`, to at most `MAX_LENGTH_S`.
    position_m
        (n, 3), scene frame.
    orientation_xyzw
        (n, 4), unit to 1e-9.
    cut
        (n,) True where the sample is a teleport: the pose before it is held until its time.
    origin_s
        Time of the first sample in the source.
    repairs
        What a reader mended, counted.
    assumed
        What a reader took for granted, in words.
    fovy_deg
        Vertical field of view that the source states; None where it has none.
    """

    name: str
    time_s: FloatArray
    position_m: FloatArray
    orientation_xyzw: FloatArray
    cut: BoolArray
    origin_s: float = 0.0
    repairs: tuple[Repair, ...] = ()
    assumed: tuple[str, ...] = ()
    fovy_deg: float | None = None
    _times: list[float] = field(init=False)
    _rows: list[tuple[float, ...]] = field(init=False)

    def __post_init__(self) -> None:
        n = np.size(self.time_s)
        if n == 0:
            raise InputError("expected at least one sample, got none; give arrays of samples")
        for name, shape in (("time_s", (n,)), ("position_m", (n, 3)), ("orientation_xyzw", (n, 4))):
            array = frozen_array(getattr(self, name), np.float64, shape, name)
            require_finite(array, name)
            object.__setattr__(self, name, array)
        object.__setattr__(self, "cut", frozen_array(self.cut, np.bool_, (n,), "cut"))
        _check_rules(self)
        rows = np.hstack([self.position_m, self.orientation_xyzw]).tolist()
        object.__setattr__(self, "_times", self.time_s.tolist())
        object.__setattr__(self, "_rows", [tuple(row) for row in rows])

    def __reduce__(self) -> tuple[type["CameraTrace"], tuple[object, ...]]:
        # Built anew where it is unpickled: arrays are read-only there too, and rows do not travel.
        arrays = (self.time_s, self.position_m, self.orientation_xyzw, self.cut)
        read = (self.origin_s, self.repairs, self.assumed, self.fovy_deg)
        return CameraTrace, (self.name, *arrays, *read)

    def __len__(self) -> int:
        return len(self._times)

    def __repr__(self) -> str:
        return f"<CameraTrace {self.name}: {self.duration_s:.1f} s, {len(self):,} poses>"

    @property
    def duration_s(self) -> float:
        """Time of the last sample."""
        return self._times[-1]

    def stretch(self, start_s: float = 0.0, end_s: float | None = None) -> "CameraTrace":
        """Return the part of the path between two times, as a path whose clock begins at 0.

        Raises `InputError` if it is empty, or not all of it is on the path.

        Parameters
        ----------
        end_s
            None for the end of the path.
        """
        end_s = self.duration_s if end_s is None else end_s
        if not 0.0 <= start_s < end_s <= self.duration_s:
            raise InputError(
                f"seconds: expected a stretch of {self.name} within 0:{self.duration_s:g}, got "
                f"{start_s:g}:{end_s:g}; name one that begins before it ends, on the path"
            )
        if (start_s, end_s) == (0.0, self.duration_s):
            return self
        inside = (self.time_s > start_s) & (self.time_s < end_s)
        first, last = self.pose_at(start_s), self.pose_at(end_s)
        # A teleport at the very end is still one; at the very start nothing comes before it.
        ends_in_cut = bool(self.cut[self.time_s == end_s].any())
        return CameraTrace(
            f"{self.name} {start_s:g}:{end_s:g} s",
            np.concatenate(((0.0,), self.time_s[inside] - start_s, (end_s - start_s,))),
            np.vstack((first.position_m, self.position_m[inside], last.position_m)),
            np.vstack(
                (first.orientation_xyzw, self.orientation_xyzw[inside], last.orientation_xyzw)
            ),
            np.concatenate(((False,), self.cut[inside], (ends_in_cut,))),
            self.origin_s + start_s,
            self.repairs,
            self.assumed,
            self.fovy_deg,
        )

    def pose_at(self, time_s: float) -> Pose:
        """Pose at one time, written in scalars because a replay asks once a frame."""
        times = self._times
        after = bisect_right(times, time_s)
        if after == 0:
            after = 1
            time_s = times[0]
        x, y, z, qx, qy, qz, qw = self._rows[after - 1]
        if after == len(times) or self.cut[after]:
            return Pose((x, y, z), (qx, qy, qz, qw))
        before_s = times[after - 1]
        t = (time_s - before_s) / (times[after] - before_s)
        nx, ny, nz, rx, ry, rz, rw = self._rows[after]
        cosine = qx * rx + qy * ry + qz * rz + qw * rw
        a, b = 1.0 - t, t
        if abs(cosine) < _NEARLY_EQUAL:
            angle = math.acos(abs(cosine))
            scale = 1.0 / math.sin(angle)
            a, b = math.sin(a * angle) * scale, math.sin(b * angle) * scale
        if cosine < 0.0:
            b = -b
        u = 1.0 - t
        position = (u * x + t * nx, u * y + t * ny, u * z + t * nz)
        turned = (a * qx + b * rx, a * qy + b * ry, a * qz + b * rz, a * qw + b * rw)
        # Products of shares round: what is equal at both ends is that to the last bit in between,
        # so that a camera at rest sees the same picture in every frame.
        if x == nx and y == ny and z == nz:
            position = (x, y, z)
        if (qx, qy, qz, qw) in ((rx, ry, rz, rw), (-rx, -ry, -rz, -rw)):
            turned = (qx, qy, qz, qw)
        return Pose(position, turned)


def first_too_late(time_s: FloatArray) -> int | None:
    """Return the first pose that comes too long after the one before it, or after the first one."""
    late = np.append(False, np.diff(time_s) > MAX_GAP_S) | (time_s - time_s[0] > MAX_LENGTH_S)
    return int(late.argmax()) if late.any() else None


def why_too_late(time_s: FloatArray, at: int) -> str:
    """Return what is wrong with the pose that `first_too_late` found."""
    gap_s, since_s = float(time_s[at] - time_s[at - 1]), float(time_s[at] - time_s[0])
    if gap_s > MAX_GAP_S:
        return f"expected poses at most an hour apart, got {_days(gap_s)} without one"
    return f"expected a path of at most {MAX_LENGTH_S / 3600:g} hours, got {_days(since_s)}"


def _days(seconds: float) -> str:
    return f"{seconds:.6g} s ({seconds / 86400.0:.3g} days)"


def _check_rules(trace: CameraTrace) -> None:
    if trace.time_s[0] != 0.0 or np.any(np.diff(trace.time_s) <= 0.0):
        raise InputError(
            "expected time_s to increase strictly from 0, got a first time other than 0, or a "
            "repeated or backward time; subtract the first time and drop repeated samples"
        )
    if (at := first_too_late(trace.time_s)) is not None:
        what = why_too_late(trace.time_s, at)
        raise InputError(f"{what} (pose {at} of {len(trace.time_s)}); split the trace there")
    norm = np.linalg.norm(trace.orientation_xyzw, axis=1)
    if np.any(np.abs(norm - 1.0) > 1e-9):
        raise InputError(
            f"expected unit quaternions, got norms from {norm.min():.6g} to {norm.max():.6g}; "
            "divide each by its norm"
        )
    if trace.cut[0]:
        raise InputError("expected cut[0] to be False, got True; nothing comes before sample 0")
