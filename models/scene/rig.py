"""Several cameras that look at a scene at once: two eyes of a head, or players side by side.

All cameras of a rig have one lens: a length on the screen is the same in whichever it is seen.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, IntArray
from ...base.errors import InputError, require_real, require_whole
from .camera import Camera
from .frustum import Culler
from .motion import Placed

MOST_APART_M = 1.0
"""Between two eyes of one head: people have 0.05 to 0.08 m, and models of towns are looked at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Eyes:
    """Two eyes of one head, each with a picture of its own.

    Attributes
    ----------
    apart_m : float
        Distance between the eyes, to either side of the path; 0 to `MOST_APART_M`.
    size_px : (width, height) or None
        Picture of each eye; None for half of the display's width.
    single_pass : bool
        Whether every object is submitted once for both eyes (instanced stereo, multiview), and
        only what it covers counts in each; else it is drawn once for each eye that sees it.
    """

    apart_m: float
    size_px: tuple[int, int] | None = None
    single_pass: bool = False

    def __post_init__(self) -> None:
        require_real(self.apart_m, "eyes")
        if not (math.isfinite(self.apart_m) and 0.0 <= self.apart_m <= MOST_APART_M):
            raise InputError(
                f"eyes: expected metres between the eyes from 0 to {MOST_APART_M:g}, got "
                f"{self.apart_m}; people have about 0.064"
            )
        for side in self.size_px or ():
            require_whole(side, "eye size", 1)

    def __str__(self) -> str:
        width_px, height_px = self.size_px or (0, 0)
        size = f", {width_px} × {height_px} px each" if self.size_px else ""
        return f"{1e3 * self.apart_m:g} mm apart{size}{', in a single pass' * self.single_pass}"

    def of(self, head: Camera) -> tuple[Camera, Camera]:
        """Return the left and the right eye of a head, both with its lens."""
        right = 0.5 * self.apart_m * head.axes[0]
        return moved(head, -right), moved(head, right)


def moved(camera: Camera, by_m: Sequence[float] | np.ndarray) -> Camera:
    """Return a camera elsewhere, turned as it was."""
    (x, y, z), (dx, dy, dz) = camera.position_m, (float(step) for step in by_m)
    return Camera(
        (x + dx, y + dy, z + dz),
        camera.orientation_xyzw,
        camera.width_px,
        camera.height_px,
        camera.fovy_rad,
        camera.near_m,
    )


@dataclass(frozen=True, slots=True)
class Rig:
    """The cameras of one frame.

    Attributes
    ----------
    cameras, previous : tuple of Camera
        Of this frame, and of the one before; none before the first.
    inside : (C, N) bool
        Nodes whose bounding sphere meets the frustum of each; valid during this frame.
    """

    cameras: tuple[Camera, ...]
    previous: tuple[Camera, ...]
    inside: BoolArray


class RigCuller:
    """Culls N nodes against several cameras at once.

    Attributes
    ----------
    inside : (N,) bool
        Nodes that any camera sees, read-only; the next cull overwrites it.
    each : (C, N) bool
        Nodes that each sees, likewise.
    at : (m,) intp
        The candidates as numpy indexes fastest.
    """

    def __init__(self, cullers: Sequence[Culler]) -> None:
        """Take a culler for each camera, all of the same nodes."""
        self._cullers = cullers
        self._each = np.zeros((len(cullers), len(cullers[0].inside)), dtype=np.bool_)
        self._inside = np.zeros(self._each.shape[1], dtype=np.bool_)
        self.each, self.inside = self._each.view(), self._inside.view()
        self.each.flags.writeable = self.inside.flags.writeable = False
        self.at = np.zeros(0, dtype=np.intp)
        self._ids: IntArray = np.zeros(0, dtype=np.int32)

    def cull(self, now: Placed, cameras: Sequence[Camera]) -> IntArray:
        """Return ids of what any camera sees, ascending; the same array where they are the same."""
        for row, culler, camera in zip(self._each, self._cullers, cameras, strict=True):
            culler.cull(now, camera)
            row[:] = culler.inside
        np.logical_or.reduce(self._each, axis=0, out=self._inside)
        at = self._inside.nonzero()[0]
        if at.tobytes() != self.at.tobytes():
            self.at, self._ids = at, at.astype(np.int32)
            at.setflags(write=False)
            self._ids.setflags(write=False)
        return self._ids
