"""``unity-adaptive``: a ladder of level biases, down by the trend of times, up by trial."""

from collections import deque
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection
from ..shared.ranges import (
    Count,
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

Action = Literal["stale", "decrease", "fast-decrease"]

_NS_PER_S = 1e9


def judge_trend(excess: FloatArray) -> Action:
    """Return what the mean of ``time / target - 1`` asks for; it never asks for more detail."""
    trend = float(np.mean(excess)) if len(excess) else 0.0
    if trend >= 0.30:
        return "fast-decrease"
    return "decrease" if trend >= 0.15 else "stale"


@dataclass
class UnityAdaptive:
    """Idea: multiply projected heights by a step of a ladder of biases: 1, 0.8, 0.6, 0.4.

    The trend is the mean of ``time / budget - 1`` over the last `samples` completed frames.  From
    0.15 it takes one step down and waits `delay_s`, from 0.30 half of that.  Below, it goes one
    step up, without knowing whether that fits, and waits `retry_s`.  So a load between two steps
    never rests: down for `delay_s`, up for `retry_s`.

    Uses: work times of completed frames, the clock, and what `static-screen` uses.

    Parameters: as below.

    Cost per frame: O(n), one visit an object.

    Reference: Unity's Adaptive Performance package, its indexer with the level-of-detail scaler;
    without a thermal sensor, whose state then counts as stale, and with the simulator's work times
    for Unity's average frame time.
    """

    min_scale: Share = 0.4  # Unity's
    max_level: Count = 3  # Unity's: biases 1, 0.8, 0.6, 0.4
    samples: PositiveInt = 120  # Unity's
    delay_s: NotNegative = 4.0  # Unity's performanceActionDelay
    retry_s: NotNegative = 10.0  # Unity's thermalActionDelay, which also delays the first action
    first: Positive = 0.25  # as static-screen
    ratio: Fraction = 0.5  # as static-screen
    hysteresis: NotNegative = 0.0  # Unity's level-of-detail groups have none

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    # The steps are fixed shares of the heights at which levels change: these say where it stands.
    knob: ClassVar[Knob] = Knob("first", 0.005, 50.0, finer="lower")

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start from the top of the ladder."""
        check_parameters(self, "unity-adaptive")
        self._static = StaticScreen(self.first, self.ratio, 1.0, self.hysteresis)
        self._static.reset(scene, budget_ms)
        self._budget_ms = budget_ms
        self._level = 0
        self._ready_ns = self.retry_s * _NS_PER_S
        self._excess: deque[float] = deque(maxlen=self.samples)
        self._reports = Reports()

    def select(self, view: View) -> Selection:
        """Take a step on the ladder if it is time, then return a level for every candidate."""
        _, new_ms = self._reports.new(view, view.completed.work_ms, self._budget_ms)
        self._excess.extend((new_ms / self._budget_ms - 1.0).tolist())
        if view.time_ns >= self._ready_ns and len(new_ms):
            self._act(view.time_ns)
        scale = 1.0 - (1.0 - self.min_scale) * self._level / max(self.max_level, 1)
        return self._static.select_biased(view, scale)

    def _act(self, time_ns: int) -> None:
        action = judge_trend(np.array(self._excess))
        step = -1 if action == "stale" else 1
        wait_s = {"stale": self.retry_s, "decrease": self.delay_s}.get(action, 0.5 * self.delay_s)
        self._level = min(max(self._level + step, 0), self.max_level)
        self._ready_ns = time_ns + wait_s * _NS_PER_S
