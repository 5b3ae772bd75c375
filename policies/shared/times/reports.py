"""Which reported times a feedback policy may believe, and how far one moves what it steers."""

import math

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....models.scene.benefit import level_primitives
from ....models.scene.scene import Scene
from ...selection import Selection
from ...view import View

_HIDDEN = 0.01
"""Share by which the drawn work may change without its time: a hundredth of 10 ms is more than the
tick of any timer, and a frame's fixed costs hide the rest."""

_CHANGES = 2
"""Changes of work, within equal reports, that tell a stuck timer: those of three frames."""


class Reports:
    """Reads the reported time of each completed frame once.

    A time that is missing, zero or negative is no time.  Reports that repeat to the last digit are
    honest where the same is drawn, as it is at rest.  Where three in a row are equal although what
    is drawn changed from each to the next, the timer is stuck until it says something else: then a
    report only counts where it speaks against detail, that is above the target, so that no stuck
    timer goes on raising detail.

    What was drawn is counted in primitives, and only where reports repeat.
    """

    def __init__(self) -> None:
        self._read = 0
        self._drawn: dict[int, Selection] = {}  # by frame, of those not yet reported
        self._last = (math.nan, math.nan)  # GPU's and asked-for time of the last good report
        self._reference: Selection | None = None  # what was drawn when the work last changed
        self._changes = 0

    def new(
        self, view: View, times_ms: FloatArray, target_ms: float
    ) -> tuple[IntArray, FloatArray]:
        """Return frames and times of the believable reports since the last call, oldest first.

        To be called in every frame.  `times_ms` is a column of the view's `completed`: the reports
        of all frames so far.
        """
        if view.previous is not None:
            self._drawn[view.frame - 1] = view.previous
        first, self._read = self._read, len(times_ms)
        good = [
            at for at in range(first, self._read) if self._believe(view, times_ms, at, target_ms)
        ]
        frames = np.array(good, dtype=np.intp)
        return frames, times_ms[frames]

    def newest_ms(self, view: View, times_ms: FloatArray, target_ms: float) -> float:
        """Return the newest believable time since the last call, or NaN; otherwise as `new`."""
        _, new_ms = self.new(view, times_ms, target_ms)
        return float(new_ms[-1]) if len(new_ms) else math.nan

    def _believe(self, view: View, times_ms: FloatArray, at: int, target_ms: float) -> bool:
        """Note one report; return whether it counts."""
        drawn = self._drawn.pop(at, None)
        time_ms = float(times_ms[at])
        if not math.isfinite(time_ms) or time_ms <= 0.0:
            return False
        # Where the CPU takes longer, work time rests while the GPU's shows that timers run.
        report = (float(view.completed.gpu_ms[at]), time_ms)
        if report != self._last:
            self._last, self._reference, self._changes = report, drawn, 0
        elif drawn is not None and _differ(view.scene, drawn, self._reference):
            self._changes += 1
            self._reference = drawn
        return time_ms > target_ms or self._changes < _CHANGES


def steer(value: float, ratio: float, gain: float, dead_band: float, rate_limit: float) -> float:
    """Return ``value · ratio^gain``, which changes it by at most the factor `rate_limit`.

    Within the dead band around 1, relative, and for NaN the value stays as it is.
    """
    if math.isnan(ratio) or abs(ratio - 1.0) <= dead_band:
        return value
    return value * min(max(ratio**gain, 1.0 / rate_limit), rate_limit)


def _differ(scene: Scene, one: Selection, other: Selection | None) -> bool:
    """Return whether two selections are so different that their times should be, too."""
    if other is None or other is one:
        return False
    now, before = _primitives(scene, one), _primitives(scene, other)
    return abs(now - before) > _HIDDEN * before


def _primitives(scene: Scene, drawn: Selection) -> float:
    """Return triangles and splats drawn, by the share of the window's pixels."""
    levels = scene.types.levels
    row, fraction = levels.position(scene.type_index[drawn.ids], drawn.detail)
    total = float(levels.interpolate(level_primitives(levels), row, fraction).sum())
    return total * drawn.render_scale**2
