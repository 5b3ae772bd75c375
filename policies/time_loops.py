"""The two feedback loops of the HLOD thesis: the time of a unit of cost, and the roots' share."""

import math

import numpy as np

from ..models.arrays import FloatArray
from ..models.camera import Camera
from ..models.predictors import FRAMEBUFFER_PIXELS
from ..models.scene import Scene
from .fresh_times import FreshTimes
from .view import View

__all__ = ["TimeLoops"]

_WIDEST = 16.0  # the roots' share stays within this factor of where it started
_STILL = 1.0 / 16.0  # a step damped below this part of its rate is no step


class TimeLoops:
    """What completed frames teach about time.

    `ms_per_unit` (the thesis' v_time) follows measured time, less the overhead, over the units
    drawn.  `share_ms` (the roots' shareTime) rises while nodes were refused and the measured time
    is below the target by the margin, and falls while it is over by the margin.  While the camera
    stands still, each turn from rising to falling or back halves the step, so that a still view
    comes to rest (ours: the thesis says only "gradually").

    Attributes
    ----------
    ms_per_unit, share_ms : float
    """

    __slots__ = (
        "_camera",
        "_expected",
        "_margin",
        "_overhead_ms",
        "_pixel_ms",
        "_refused",
        "_share_bounds_ms",
        "_share_rate",
        "_step",
        "_target_ms",
        "_time_rate",
        "_times",
        "_turn",
        "_units",
        "ms_per_unit",
        "share_ms",
    )

    def __init__(
        self,
        scene: Scene,
        units: FloatArray,
        target_ms: float,
        *,
        time_rate: float,
        share_rate: float,
        margin: float,
    ) -> None:
        self._target_ms, self._margin = target_ms, margin
        self._time_rate, self._share_rate, self._step = time_rate, share_rate, share_rate
        self._turn = 0
        self._times = FreshTimes()
        self._units: list[float] = []
        self._refused = False
        self._camera: Camera | None = None
        self._overhead_ms = self._pixel_ms = 0.0
        # Without a cost model the roots are taken to fill the target.
        self.ms_per_unit = target_ms / float(units[scene.roots].sum())
        if scene.costs is not None:
            linear, geometry = scene.costs.level_ms(scene.types.levels)
            finest = scene.types.levels.start[:-1][scene.type_index]
            known_ms = float((linear + geometry)[finest].sum())
            self._overhead_ms = scene.costs.base_ms
            self._pixel_ms = float(scene.costs.linear_ms[FRAMEBUFFER_PIXELS])
            if known_ms > 0.0:
                self.ms_per_unit = known_ms / float(units.sum())
        self.share_ms = max(target_ms - self._overhead_ms, 0.1 * target_ms)
        self._share_bounds_ms = (self.share_ms / _WIDEST, self.share_ms * _WIDEST)

    def learn(self, view: View) -> None:
        """Take the newest report, if there is one, before a frame is chosen."""
        if self._camera is None:
            self._overhead_ms += self._pixel_ms * view.camera.viewport_px
        self._restart_if_moved(view.camera)
        report = self._times.newest(view.completed.gpu_ms)
        if report is None:
            return
        frame, time_ms = report
        drawn = self._units[frame]
        if drawn > 0.0 and time_ms > self._overhead_ms:
            sample = (time_ms - self._overhead_ms) / drawn
            self.ms_per_unit += self._time_rate * (sample - self.ms_per_unit)
        if time_ms > (1.0 + self._margin) * self._target_ms:
            self._move_share(-1)
        elif self._refused and time_ms < (1.0 - self._margin) * self._target_ms:
            self._move_share(1)

    def expect(self, units: float, *, refused: bool) -> float:
        """Note what a frame draws and if nodes were refused; return the time it should take."""
        self._units.append(units)
        self._refused = refused
        return self._overhead_ms + self.ms_per_unit * units

    def _restart_if_moved(self, camera: Camera) -> None:
        before, self._camera = self._camera, camera
        if before is not None and (
            before.position_m != camera.position_m
            or before.orientation_xyzw != camera.orientation_xyzw
        ):
            self._step, self._turn = self._share_rate, 0

    def _move_share(self, turn: int) -> None:
        if turn == -self._turn:
            self._step *= 0.5
        self._turn = turn
        if self._step > _STILL * self._share_rate:
            share_ms = self.share_ms * math.pow(1.0 + self._step, turn)
            self.share_ms = float(np.clip(share_ms, *self._share_bounds_ms))
