"""Look for a short camera path on which a policy does badly.

A path is made of legs of equal time, each with a speed and a turn rate within the limits, so that
every point of the unit cube is a path that keeps them.  The cube is searched from the best of many
scattered points (a scrambled Sobol sequence) by Powell's method, which needs no derivative
("An efficient method for finding the minimum of a function of several variables without calculating
derivatives", The Computer Journal 1964).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...models.scene.extent import scene_extent
from ...models.scene.scene import Scene
from ...traces.cameras.camera_trace import CameraTrace
from ...traces.cameras.generators.tour import EYE_M
from ...traces.cameras.orientation import look_along
from .badness import Gauge
from .runs import Progress

_RATE_HZ = 60.0
_SCATTERED = 0.5  # share of the evaluations that are no local search
_RESTARTS = 3  # local searches, from the best scattered points
_STEP = 0.15  # of the cube: first steps of a local search


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLimits:
    """What a path may be.

    Attributes
    ----------
    speed_m_s, turn_deg_s : float
        Bounds of speed and turn rate.
    duration_s : float
    legs : int
    """

    speed_m_s: float = 7.0  # a person who runs, as in the generated `dash`
    turn_deg_s: float = 180.0  # as in the generated `dash`
    duration_s: float = 3.0
    legs: int = 6

    def __post_init__(self) -> None:
        for name, low, high in (
            ("speed_m_s", 0.0, 1e4),
            ("turn_deg_s", 0.0, 1e4),
            ("duration_s", 0.5, 600.0),
            ("legs", 1, 100),
        ):
            value = getattr(self, name)
            if not low <= value <= high:
                raise InputError(f"{name}: expected {low:g} to {high:g}, got {value}")


@dataclass(frozen=True, slots=True, eq=False)
class WorstPath:
    """The worst path of a search.

    Attributes
    ----------
    trace : CameraTrace
    value : float
    evaluations : int
        Replays that the search took.
    """

    trace: CameraTrace
    value: float
    evaluations: int


def path_of(point: FloatArray, scene: Scene, limits: PathLimits) -> CameraTrace:
    """Return the path that a point of the unit cube stands for.

    Parameters
    ----------
    point : (3 + 2 legs,) float64
        Where in the scene's extent the path starts, its heading, then speeds, then turn rates.
    """
    middle, size = scene_extent(scene)
    legs = limits.legs
    times = np.linspace(0.0, limits.duration_s, round(limits.duration_s * _RATE_HZ) + 1)
    step_s = times[1]
    leg = np.minimum((times[:-1] * legs / limits.duration_s).astype(np.intp), legs - 1)
    speed_m_s = limits.speed_m_s * point[3 : 3 + legs][leg]
    turn_rad_s = np.radians(limits.turn_deg_s) * (2.0 * point[3 + legs :][leg] - 1.0)
    heading_rad = 2.0 * np.pi * point[2] + np.append(0.0, np.cumsum(turn_rad_s * step_s))
    ahead = np.column_stack((np.cos(heading_rad[:-1]), np.sin(heading_rad[:-1])))
    steps_m = (speed_m_s * step_s)[:, np.newaxis] * ahead
    start_m = middle[:2] + (point[:2] - 0.5) * size[:2]
    plan_m = start_m + np.vstack((np.zeros(2), np.cumsum(steps_m, axis=0)))
    eye_m = middle[2] - 0.5 * size[2] + EYE_M
    return CameraTrace(
        "stress",
        times,
        np.column_stack((plan_m, np.full(len(times), eye_m))),
        look_along(heading_rad, np.zeros_like(heading_rad)),
        np.zeros(len(times), dtype=np.bool_),
    )


def stress(
    gauge: Gauge,
    scene: Scene,
    limits: PathLimits,
    *,
    seed: int = 0,
    evaluations: int = 100,
    progress: Progress | None = None,
) -> WorstPath:
    """Search for the path on which a policy is worst; the same arguments find the same path.

    Raises `InputError` if there are too few evaluations to search with, and what the gauge raises
    (see `open_gauge`).
    """
    if evaluations < 8:
        raise InputError(f"evaluations: expected at least 8, got {evaluations}")
    search = _Search(lambda point: gauge(path_of(point, scene, limits)), evaluations, progress)
    search.run(3 + 2 * limits.legs, seed)
    return WorstPath(path_of(search.best, scene, limits), search.value, search.done)


class _Exhausted(Exception):  # noqa: N818 - ends a local search, which has no other way to stop
    pass


class _Search:
    """A search of the unit cube with a bounded number of evaluations."""

    def __init__(
        self,
        badness_at: Callable[[FloatArray], float],
        evaluations: int,
        progress: Progress | None,
    ) -> None:
        self._badness_at, self._evaluations, self._progress = badness_at, evaluations, progress
        self.best, self.value, self.done = np.zeros(0), -np.inf, 0

    def run(self, dimensions: int, seed: int) -> None:
        """Scatter points, then search about the best of them."""
        from scipy.stats import qmc

        count = max(int(self._evaluations * _SCATTERED), 4)
        sobol = qmc.Sobol(dimensions, rng=seed)
        points: FloatArray = sobol.random_base2(int(np.ceil(np.log2(count))))[:count]
        costs = [self._cost(point) for point in points]
        for start in np.argsort(costs, kind="stable")[:_RESTARTS].tolist():
            share = (self._evaluations - count) // _RESTARTS
            self._descend(points[start], self.done + share)

    def _descend(self, start: FloatArray, until: int) -> None:
        """Search about a point until so many evaluations are done in all."""
        from scipy.optimize import minimize

        def cost(point: FloatArray) -> float:
            if self.done >= until:
                raise _Exhausted
            return self._cost(np.clip(point, 0.0, 1.0))

        directions: Any = _STEP * np.eye(len(start))
        try:
            minimize(
                cost,
                start,
                method="Powell",
                bounds=[(0.0, 1.0)] * len(start),
                options={"direc": directions, "xtol": 0.05, "ftol": 1e-3},
            )
        except _Exhausted:
            return

    def _cost(self, point: FloatArray) -> float:
        value = self._badness_at(point)
        self.done += 1
        if value > self.value:
            self.best, self.value = point.copy(), value
        if self._progress is not None:
            self._progress(self.done, self._evaluations)
        return -value
