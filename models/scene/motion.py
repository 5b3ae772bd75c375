"""Motion of objects: some nodes go round horizontal circles through their rest position."""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from ...base.arrays import FloatArray, IntArray, derive, freeze


@dataclass(frozen=True, slots=True)
class Motion:
    """M moving nodes; closed form in time, so that a replay needs no integration.

    Attributes
    ----------
    node : (M,) int32
    radius_m : (M,) float64
    rate_rad_s : (M,) float64
    phase_rad : (M,) float64
    """

    node: Annotated[IntArray, np.int32, "M"]
    radius_m: Annotated[FloatArray, np.float64, "M"]
    rate_rad_s: Annotated[FloatArray, np.float64, "M"]
    phase_rad: Annotated[FloatArray, np.float64, "M"]
    _start: FloatArray = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        freeze(self, "motion", M=len(self.node))
        derive(self, _start=np.stack((np.cos(self.phase_rad), np.sin(self.phase_rad))))

    def offset_m(self, time_s: float) -> FloatArray:
        """Return (2, M) displacements from rest along x and y at a time; zero at time 0."""
        angle = self.rate_rad_s * time_s
        angle += self.phase_rad
        turned = np.empty((2, len(angle)))
        np.cos(angle, out=turned[0])
        np.sin(angle, out=turned[1])
        turned -= self._start
        turned *= self.radius_m
        return turned


class Centers:
    """Where the centres of N bounding spheres are at any time, as columns (x, y, z, 1).

    The last row lets one product with a camera's pose turn and shift them.
    """

    def __init__(self, center_m: FloatArray, motion: Motion | None) -> None:
        """Take centres at rest, (N, 3), and what moves of them."""
        n = len(center_m)
        self._rest_m = np.ones((4, n))
        self._rest_m[:3] = center_m.T
        self._rest_m.flags.writeable = False
        self._motion = motion
        node = np.zeros(0, dtype=np.intp) if motion is None else motion.node.astype(np.intp)
        # Positions of x and y among all numbers: one assignment places both.
        self._moving = np.concatenate((node, node + n))
        self._moving_m = self._rest_m.take(self._moving).reshape(2, -1)

    def at(self, time_s: float) -> FloatArray:
        """Return (4, N) centres at a time, read-only; one array for ever where nothing moves."""
        if self._motion is None:
            return self._rest_m
        moved_m = self._motion.offset_m(time_s)
        moved_m += self._moving_m
        centers_m = self._rest_m.copy()
        centers_m.reshape(-1)[self._moving] = moved_m.reshape(-1)
        centers_m.flags.writeable = False
        return centers_m
