"""``hoppe``: a screen-space tolerance steered towards a number of triangles, or a time."""

import math
from dataclasses import dataclass
from typing import ClassVar

from ...models.scene.benefit import level_primitives
from ...models.scene.camera import Camera
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection
from ..shared.knobs import TARGET
from ..shared.levels.error_ladder import ErrorLadder
from ..shared.ranges import NotNegative, Positive, Share, check_parameters
from ..shared.times.reports import Reports
from ..view import View

_CLOSE = 1.01
"""Over the tolerance that led above m, one that need not come nearer: less than a level's step."""


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

    Levels are steps, so that often no tolerance meets m, and the rule alone goes to and fro between
    two.  With `rest`, while neither camera nor objects move, a tolerance that led above m is not
    gone below again: tau goes half of the way towards it, by its log, and stays within 1 % of it.

    Uses: errors of levels, distance, own triangles or work times of completed frames, and whether
    the camera moved.

    Parameters: as below.

    Cost per frame: O(n L), one visit an object.

    Reference: Hoppe, "View-dependent refinement of progressive meshes", SIGGRAPH 1997, and "Smooth
    view-dependent level-of-detail control", Visualization 1998, which regulate the tolerance by the
    count of the last frame; the exponent, the regulation of times and the rest are ours.
    """

    triangles: Positive | None = None  # m; None: regulate the time instead
    gain: NotNegative | None = None  # None: 1 (Hoppe's rule) on triangles, by the delay on times
    start_px: float = 1.0  # tau of the first frame; ours
    min_px: Positive = 0.1  # ours
    max_px: float = 64.0  # ours
    target: Share = 0.9  # as feedback
    rest: bool = True  # ours: off is the printed rule

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
        self._used_px: list[float] = []  # tolerance of each frame
        self._rests_since = 0  # frame from which on nothing has moved
        self._over_px = 0.0  # the largest tolerance that led above m since then
        self._reports = Reports()
        self._ladder = ErrorLadder(scene)

    def select(self, view: View) -> Selection:
        """Steer the tolerance, then return a level for every candidate."""
        if not _at_rest(view):
            self._rests_since, self._over_px = len(self._used_px), 0.0
        frame, ratio, gain = self._measure(view)
        if ratio > 0.0:  # not if nothing is known or nothing was drawn
            if ratio > 1.0 and frame >= self._rests_since:
                self._over_px = max(self._over_px, self._used_px[frame])
            log_px = math.log(self._tolerance_px) + gain * math.log(ratio)
            low, high = math.log(self.min_px), math.log(self.max_px)
            self._tolerance_px = self._above_over(math.exp(min(max(log_px, low), high)))
        self._used_px.append(self._tolerance_px)
        selection = self._ladder.select(view, self._tolerance_px, 0.0)
        if self.triangles is not None:
            levels = view.scene.types.levels
            row, fraction = levels.position(view.type_index, selection.detail)
            self._drawn = float(levels.interpolate(level_primitives(levels), row, fraction).sum())
        return selection

    def _above_over(self, wanted_px: float) -> float:
        """Return a tolerance that does not go below one that is known to lead above m."""
        now_px, over_px = self._tolerance_px, self._over_px
        if not self.rest or wanted_px > _CLOSE * over_px or now_px <= over_px:
            return wanted_px
        # Halving the way ends: either nothing is above m any more, or the step between is found.
        return now_px if now_px <= _CLOSE * over_px else math.sqrt(now_px * over_px)

    def _measure(self, view: View) -> tuple[int, float, float]:
        """Return a frame, its work over the target, NaN if nothing is known, and the gain."""
        if self.triangles is not None:
            gain = 1.0 if self.gain is None else self.gain
            return len(self._used_px) - 1, self._drawn / self.triangles, gain
        frames, times_ms = self._reports.new(view, view.completed.work_ms, self._target_ms)
        delay = view.frame - len(view.completed)
        gain = 0.5 * critical_gain(delay) if self.gain is None else self.gain
        if not len(frames):
            return 0, math.nan, gain
        return int(frames[-1]), float(times_ms[-1]) / self._target_ms, gain


def _at_rest(view: View) -> bool:
    before, rig = view.state.previous_camera, view.state.rig
    if before is None or view.scene.motion is not None:
        return False
    if rig is not None:
        return all(map(_stands, rig.previous, rig.cameras))
    return _stands(before, view.camera)


def _stands(before: Camera, now: Camera) -> bool:
    moved_m = math.dist(now.position_m, before.position_m)
    # Between two equal poses interpolation may round.
    return moved_m < 1e-9 and math.dist(now.orientation_xyzw, before.orientation_xyzw) < 1e-12
