"""``unreal-dynamic``: Unreal's dynamic resolution, applied to level bias or to render scale."""

import math
from collections import deque
from dataclasses import dataclass, replace
from typing import ClassVar, Literal

from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection
from ..shared.ranges import (
    BelowOne,
    Fraction,
    NotNegative,
    Positive,
    PositiveInt,
    Share,
    check_parameters,
)
from ..shared.times.reports import Reports
from ..thresholds.static_screen import StaticScreen
from ..view import View

_IN_FLIGHT = 64  # frames for which fractions are kept: more than a queue and a timer hold back


def suggest_fraction(target_ms: float, time_ms: float, fraction: float) -> float:
    """Return the fraction at which a frame would take the target, if time goes by its square."""
    return math.sqrt(target_ms / time_ms) * fraction


@dataclass
class UnrealDynamic:
    """Idea: scale detail by a fraction as past frames suggest, ``sqrt(target / time) · fraction``.

    The suggestions of the last `history` completed frames are averaged with weights ``0.9^age``.
    The fraction changes at most every `period` frames, goes only `increase` of the way up at a
    time, and ignores changes up to `threshold`.  After `panic` frames in a row over the budget it
    goes at once to what those suggest, and forgets the history.  Times arrive late, so each is
    judged with the fraction at which its frame was drawn.

    With ``apply=bias`` the fraction multiplies projected heights of `static-screen`; with
    ``render-scale`` levels stay at a bias of 1 and both sides of the picture are scaled.

    Uses: GPU times of completed frames, and what `static-screen` uses.

    Parameters: as below.

    Cost per frame: O(n), one visit an object.

    Reference: Unreal Engine's ``r.DynamicRes`` (defaults of its console variables).
    """

    apply: Literal["bias", "render-scale"] = "bias"  # ours; Unreal scales pixels
    headroom: BelowOne = 0.1  # Unreal's r.DynamicRes.TargetedGPUHeadRoomPercentage, 10 %
    min_fraction: Share = 0.5  # Unreal's MinScreenPercentage
    max_fraction: Share = 1.0  # Unreal's MaxScreenPercentage
    history: PositiveInt = 16  # Unreal's HistorySize
    weight: Share = 0.9  # Unreal's FrameWeightExponent
    period: PositiveInt = 8  # Unreal's MinResolutionChangePeriod, frames
    increase: Share = 0.9  # Unreal's IncreaseAmortizationBlendFactor
    threshold: NotNegative = 0.02  # Unreal's ChangePercentageThreshold
    panic: PositiveInt = 2  # Unreal's MaxConsecutiveOverbudgetGPUFrameCount
    first: Positive = 0.25  # as static-screen
    ratio: Fraction = 0.5  # as static-screen
    hysteresis: NotNegative = 0.0  # as Unity's; the controller has its own threshold

    rising: ClassVar[tuple[str, ...]] = ("min_fraction", "max_fraction")
    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    # The headroom only matters where the fraction that it asks for lies within the fraction's two
    # ends, a factor of two; the thresholds of the levels that it scales have no such ends.
    knob: ClassVar[Knob] = Knob("first", 0.005, 50.0, finer="lower")

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start from the largest fraction."""
        check_parameters(self, "unreal-dynamic")
        self._static = StaticScreen(self.first, self.ratio, 1.0, self.hysteresis)
        self._static.reset(scene, budget_ms)
        self._budget_ms = budget_ms
        self._fraction = self.max_fraction
        self._changed, self._over = 0, 0
        self._past: deque[float] = deque(maxlen=self.history)
        self._drawn_at: list[float] = [self.max_fraction] * _IN_FLIGHT
        self._reports = Reports()

    def select(self, view: View) -> Selection:
        """Change the fraction if past frames say so, then return a level for every candidate."""
        self._read(view)
        if self._over >= self.panic:
            self._change(self._average(self._over), view.frame)
            self._past.clear()
            self._over = 0
        elif self._past and view.frame - self._changed >= self.period:
            wanted = self._average(self.history)
            if wanted > self._fraction:
                wanted = self._fraction + self.increase * (wanted - self._fraction)
            wanted = self._clamp(wanted)
            if abs(wanted / self._fraction - 1.0) > self.threshold:
                self._change(wanted, view.frame)
        self._drawn_at[view.frame % _IN_FLIGHT] = self._fraction
        if self.apply == "bias":
            return self._static.select_biased(view, self._fraction)
        return replace(self._static.select_biased(view, 1.0), render_scale=self._fraction)

    def _read(self, view: View) -> None:
        """Note new times, newest first, and how many in a row are over the budget."""
        target_ms = (1.0 - self.headroom) * self._budget_ms
        frames, times_ms = self._reports.new(view, view.completed.gpu_ms, target_ms)
        for frame, time_ms in zip(frames.tolist(), times_ms.tolist(), strict=True):
            slot: int = frame % _IN_FLIGHT
            drawn_at = self._drawn_at[slot]
            self._past.appendleft(suggest_fraction(target_ms, time_ms, drawn_at))
            self._over = self._over + 1 if time_ms > self._budget_ms else 0

    def _average(self, count: int) -> float:
        """Return the weighted mean of the newest suggestions."""
        total = weights = 0.0
        weight = 1.0
        for suggestion in list(self._past)[:count]:
            total += weight * suggestion
            weights += weight
            weight *= self.weight
        return total / weights

    def _clamp(self, fraction: float) -> float:
        return min(max(fraction, self.min_fraction), self.max_fraction)

    def _change(self, fraction: float, frame: int) -> None:
        self._fraction = self._clamp(fraction)
        self._changed = frame
