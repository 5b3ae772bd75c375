"""The two feedback loops of the HLOD thesis: the time of a unit of cost, and the roots' share."""

import math

import numpy as np

from ....base.arrays import FloatArray
from ....base.predictors import LEVEL_PREDICTORS
from ....models.machine.frame_cost import FrameCost
from ....models.scene.scene import Scene
from ...view import View
from .reports import Reports

_TRIANGLES = LEVEL_PREDICTORS.index("triangles")
_TEXTURED = LEVEL_PREDICTORS.index("textured_triangles")
_WIDEST = 16.0  # the roots' share stays within this factor of where it started


class TimeLoops:
    """What completed frames teach about time.

    `ms_per_unit` (the thesis' v_time) follows measured time, less the overhead, over the units
    drawn.  `share_ms` (the roots' shareTime) rises while nodes are refused and the time is below
    the target by the margin, and falls while it is over by the margin.  The time is the measured
    one and what the switches under way will add to it (ours): counters take long to act on a new
    share, and a loop that waited for them would overshoot and swing.

    Attributes
    ----------
    ms_per_unit, share_ms : float
    """

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
        self._time_rate, self._share_rate = time_rate, share_rate
        self._reports = Reports()
        self._units: list[float] = []
        self._refused, self._pending = False, 0.0
        self._overhead_ms, self._costs = 0.0, None
        # Without a cost model the roots are taken to fill the target.
        self.ms_per_unit = target_ms / float(units[scene.roots].sum())
        if scene.costs is not None:
            costs = self._costs = FrameCost(scene.costs, scene.types.levels)
            finest, levels = scene.finest_row, scene.types.levels
            known_ms = float((costs.level_ms + costs.geometry_ms)[finest].sum())
            # A term of each object, though no view changes it.
            plain = np.maximum(levels.counts[:, _TRIANGLES] - levels.counts[:, _TEXTURED], 0.0)
            known_ms += scene.costs.unit_ms("untextured_triangles") * float(plain[finest].sum())
            self._overhead_ms = scene.costs.base_ms
            if known_ms > 0.0:
                self.ms_per_unit = known_ms / float(units.sum())
        self.share_ms = max(target_ms - self._overhead_ms, 0.1 * target_ms)
        self._share_bounds_ms = (self.share_ms / _WIDEST, self.share_ms * _WIDEST)

    def learn(self, view: View) -> None:
        """Take the newest report, if there is one, before a frame is chosen."""
        if self._costs is not None and not self._units:
            self._overhead_ms = self._costs.fixed_ms(view.viewport_px, 0)
        frames, times_ms = self._reports.new(view, view.completed.gpu_ms, self._target_ms)
        if not len(frames):
            return
        drawn, time_ms = self._units[int(frames[-1])], float(times_ms[-1])
        if drawn > 0.0 and time_ms > self._overhead_ms:
            sample = (time_ms - self._overhead_ms) / drawn
            self.ms_per_unit += self._time_rate * (sample - self.ms_per_unit)
        time_ms += self.ms_per_unit * self._pending
        if time_ms > (1.0 + self._margin) * self._target_ms:
            self._move_share(-1)
        elif self._refused and time_ms < (1.0 - self._margin) * self._target_ms:
            self._move_share(1)

    def expect(self, units: float, pending: float, *, refused: bool) -> float:
        """Note the units of a frame, those of switches under way, and if nodes are refused.

        Returns the time that the frame should take.
        """
        self._units.append(units)
        self._refused, self._pending = refused, pending
        return self._overhead_ms + self.ms_per_unit * units

    def _move_share(self, turn: int) -> None:
        share_ms = self.share_ms * math.pow(1.0 + self._share_rate, turn)
        self.share_ms = float(np.clip(share_ms, *self._share_bounds_ms))
