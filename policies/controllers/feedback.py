"""``feedback``: screen thresholds steered by the times of completed frames."""

from dataclasses import dataclass
from typing import ClassVar

from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection
from ..shared.knobs import TARGET
from ..shared.ranges import AtLeastOne, Fraction, NotNegative, Positive, Share, check_parameters
from ..shared.times.reports import Reports, steer
from ..thresholds.static_screen import StaticScreen
from ..view import View


@dataclass
class Feedback:
    """Idea: multiply projected heights by a bias, ``bias · (target / time)^gain`` once a frame.

    Inside the dead band the bias rests; one step changes it by at most the rate limit.  A report
    that is missing, zero or negative is no time and moves nothing; those of a stuck timer
    (`shared.times.reports`) do not raise detail.

    Uses: work time of the newest completed frame, and what `static-screen` uses.

    Parameters: `target` (share of the budget to aim at), `gain`, `dead_band` (relative),
    `rate_limit` (largest factor a frame), `min_bias`, `max_bias`, and those of `static-screen`.

    Cost per frame: O(n), one visit an object.

    Reference: the feedback algorithm that Funkhouser and Séquin (SIGGRAPH 1993) compare with, in
    the form of Unreal's dynamic resolution (``sqrt(target / time)``, gain 0.5); stable with
    measurements k frames late while gain times the load's elasticity is below
    ``2 cos(kπ / (2k + 1))``.
    """

    target: Share = 0.9  # Unreal's headroom of 10 %
    gain: NotNegative = 0.5  # Unreal's square root
    dead_band: NotNegative = 0.05  # ours
    rate_limit: AtLeastOne = 1.1  # ours: at most 10 % a frame
    min_bias: Share = 0.05  # ours
    max_bias: AtLeastOne = 64.0  # ours: enough for full detail of all that is in view
    first: Positive = 0.25  # as static-screen
    ratio: Fraction = 0.5  # as static-screen
    hysteresis: NotNegative = 0.01  # as static-screen

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = TARGET

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start from a bias of 1."""
        check_parameters(self, "feedback")
        self._levels = StaticScreen(self.first, self.ratio, 1.0, self.hysteresis)
        self._levels.reset(scene, budget_ms)
        self._target_ms = self.target * budget_ms
        self._bias = 1.0
        self._reports = Reports()

    def select(self, view: View) -> Selection:
        """Steer the bias, then return a level for every candidate."""
        time_ms = self._reports.newest_ms(view, view.completed.work_ms, self._target_ms)
        ratio = time_ms / self._target_ms
        bias = steer(self._bias, ratio, -self.gain, self.dead_band, self.rate_limit)
        self._bias = min(max(bias, self.min_bias), self.max_bias)
        return self._levels.select_biased(view, self._bias)
