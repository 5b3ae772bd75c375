"""``hoppe``: a screen-space tolerance steered towards a number of triangles, or a time."""

import math
from dataclasses import dataclass
from typing import ClassVar

from ...models.scene.benefit import level_primitives
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection
from ..shared.error_ladder import ErrorLadder
from ..shared.knobs import TARGET
from ..shared.ranges import NotNegative, Positive, Share, check_parameters
from ..shared.reports import Reports
from ..view import View


def critical_gain(delay: int) -> float:
    """Return the largest stable product of gain and elasticity, measurements `delay` frames late.

    If work is ``K · tau^(-p)`` and ``tau <- tau · (work / target)^g``, the log of work over target
    obeys ``e(t+1) = e(t) - g p e(t-k)``, stable for ``0 < g p < 2 cos(k pi / (2k + 1))``.
    """
    return 2.0 * math.cos(delay * math.pi / (2 * delay + 1))


@dataclass
class Hoppe:
    """Idea: ``tau <- tau · (n / m)^gain`` each frame; levels as `pixel-error` with threshold tau.

    With `triangles` given, n is what the last selection drew, known at once, and m is that number.
    Without, n is the work time of the newest completed frame and m the target share of the budget;
    that time is k frames late, and unless `gain` is given it is half the gain at which a loop so
    late begins to oscillate if work falls as ``1 / tau`` (`critical_gain`).

    Uses: errors of levels, distance, own triangles or work times of completed frames.

    Parameters: as below.

    Cost per frame: O(n L), one visit an object.

    Reference: Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997, and "Smooth
    view-dependent level-of-detail control", Visualization 1998, which regulate the tolerance by the
    count of the last frame; the exponent and the regulation of times are ours.
    """

    triangles: Positive | None = None  # m; None: regulate the time instead
    gain: NotNegative | None = None  # None: 1 (Hoppe's rule) on triangles, by the delay on times
    start_px: float = 1.0  # tau of the first frame; ours
    min_px: Positive = 0.1  # ours
    max_px: float = 64.0  # ours
    target: Share = 0.9  # as feedback

    rising: ClassVar[tuple[str, ...]] = ("min_px", "start_px", "max_px")
    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)

    @property
    def knob(self) -> Knob:
        """What is regulated: the number of triangles if one is given, else the time."""
        if self.triangles is not None:
            return Knob("triangles", 1e3, 1e8)
        return TARGET

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start from the tolerance of the first frame."""
        check_parameters(self, "hoppe")
        self._target_ms = self.target * budget_ms
        self._tolerance_px = self.start_px
        self._drawn = math.nan
        self._reports = Reports()
        self._ladder = ErrorLadder(scene)

    def select(self, view: View) -> Selection:
        """Steer the tolerance, then return a level for every candidate."""
        ratio, gain = self._measure(view)
        if ratio > 0.0:  # not if nothing is known or nothing was drawn
            log_px = math.log(self._tolerance_px) + gain * math.log(ratio)
            low, high = math.log(self.min_px), math.log(self.max_px)
            self._tolerance_px = math.exp(min(max(log_px, low), high))
        selection = self._ladder.select(view, self._tolerance_px, 0.0)
        if self.triangles is not None:
            levels = view.scene.types.levels
            row, fraction = levels.position(view.type_index, selection.detail)
            self._drawn = float(levels.interpolate(level_primitives(levels), row, fraction).sum())
        return selection

    def _measure(self, view: View) -> tuple[float, float]:
        """Return work over target, NaN if nothing new is known, and the gain to apply."""
        if self.triangles is not None:
            return self._drawn / self.triangles, 1.0 if self.gain is None else self.gain
        time_ms = self._reports.newest_ms(view, view.completed.work_ms, self._target_ms)
        delay = view.frame - len(view.completed)
        gain = 0.5 * critical_gain(delay) if self.gain is None else self.gain
        return time_ms / self._target_ms, gain
