"""Motion of objects: some nodes go round horizontal circles through their rest position."""

import math
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray, derive, freeze

_TURN_RAD = 0.5  # farthest that a node turns from the instant of its series
_TERMS = 14  # of a series: 0.5^14 / 14! is below 1e-15
_EXPONENTS = np.arange(float(_TERMS))
_ROW = 512  # numbers that are multiplied at once: BLAS starts no threads for so few


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
        angle = self.rate_rad_s * time_s + self.phase_rad
        return (np.stack((np.cos(angle), np.sin(angle))) - self._start) * self.radius_m

    def series(self, time_s: float, terms: int) -> FloatArray:
        """Return displacements around a time as a power series, (terms, 2, M).

        Term k times the k-th power of the seconds since then, added up, is `offset_m`.
        """
        angle = self.rate_rad_s * time_s + self.phase_rad
        cosine, sine = np.cos(angle), np.sin(angle)
        # Each derivative is a quarter turn ahead of the one before: x and y after 0 to 3 of them.
        turned = np.array(((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine)))
        scale_m = np.empty((terms, 1, len(angle)))
        scale_m[0] = self.radius_m
        np.divide(self.rate_rad_s, np.arange(1.0, terms)[:, None, None], out=scale_m[1:])
        np.multiply.accumulate(scale_m, axis=0, out=scale_m)
        series = turned[np.arange(terms) % 4]
        series *= scale_m
        series[0] -= self._start * self.radius_m
        return series


class Placed:
    """Where the centres of N bounding spheres are at one time; never changes.

    Attributes
    ----------
    moved_m : (2, M) float64
        x and y of the nodes that move.
    """

    __slots__ = ("_all_m", "_moving", "_rest_m", "moved_m")

    def __init__(self, rest_m: FloatArray, moving: NDArray[np.intp], moved_m: FloatArray) -> None:
        """Take (3, N) centres at rest, read-only, and which nodes, (M,), have moved where."""
        self._rest_m, self._moving, self.moved_m = rest_m, moving, moved_m
        self._all_m: FloatArray | None = None if len(moving) else rest_m

    @classmethod
    def at_rest(cls, centers_m: FloatArray) -> "Placed":
        """Return given (3, N) centres of which none moves."""
        return cls(centers_m, np.zeros(0, dtype=np.intp), np.zeros((2, 0)))

    @property
    def all_m(self) -> FloatArray:
        """All centres, (3, N), read-only; put together when first asked for."""
        if self._all_m is None:
            self._all_m = self._rest_m.copy()
            self._all_m[:2, self._moving] = self.moved_m
            self._all_m.flags.writeable = False
        return self._all_m


class Centers:
    """Where the centres of N bounding spheres are at any time.

    Nodes move by power series around instants between which none of them turns by more than a
    radian: one product of a vector and a matrix, where sines and cosines would take several times
    as long.  What is left out is below 1e-15 of a circle's radius.

    Attributes
    ----------
    rest_m : (4, N) float64
        Centres at rest as columns (x, y, z, 1), read-only: the last row lets one product with a
        camera's pose turn and shift them.
    moving : (M,) intp
        The nodes that move.
    """

    def __init__(self, center_m: FloatArray, motion: Motion | None) -> None:
        """Take centres at rest, (N, 3), and what moves of them."""
        self.rest_m = np.ones((4, len(center_m)))
        self.rest_m[:3] = center_m.T
        self.rest_m.flags.writeable = False
        self._motion = motion
        self.moving = np.zeros(0, dtype=np.intp) if motion is None else motion.node.astype(np.intp)
        self._at_rest = Placed.at_rest(self.rest_m[:3])
        fastest = 0.0 if motion is None else float(np.abs(motion.rate_rad_s).max(initial=0.0))
        self._step_s = 2.0 * _TURN_RAD / max(fastest, 1e-3)
        self._step = math.nan
        self._centre_m = self.rest_m[:2].take(self.moving, axis=1)
        self._series = np.zeros((0, _TERMS, _ROW))

    def at(self, time_s: float) -> Placed:
        """Return the centres at a time; one and the same for ever where nothing moves."""
        if self._motion is None:
            return self._at_rest
        step = math.floor(time_s / self._step_s)
        middle_s = (step + 0.5) * self._step_s
        if step != self._step:
            self._step, self._series = step, self._around(self._motion, middle_s)
        xy_m = np.matmul((time_s - middle_s) ** _EXPONENTS, self._series).reshape(-1)
        moved_m = xy_m[: 2 * len(self.moving)].reshape(2, -1)
        moved_m.setflags(write=False)
        return Placed(self.rest_m[:3], self.moving, moved_m)

    def _around(self, motion: Motion, time_s: float) -> FloatArray:
        """Return the series of x and y around a time, in rows that BLAS needs no threads for."""
        series = motion.series(time_s, _TERMS)
        series[0] += self._centre_m
        flat = series.reshape(_TERMS, -1)
        padded = np.zeros((_TERMS, -(-flat.shape[1] // _ROW) * _ROW))
        padded[:, : flat.shape[1]] = flat
        return np.ascontiguousarray(padded.reshape(_TERMS, -1, _ROW).swapaxes(0, 1))
