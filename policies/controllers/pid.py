"""``pid``: an angle of detail steered by a controller with hifi's gains."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection
from ..shared.ranges import AtLeastOne, Fraction, Interval, NotNegative, Positive, check_parameters
from ..shared.times.reports import Reports
from ..thresholds.static_screen import StaticScreen
from ..view import View


@dataclass
class Pid:
    """Idea: add the output of a PID controller on the frame rate to an angle of detail, in degrees.

    Our reading of the angle: an object that appears as large is drawn at its finest level, one of
    `ratio` times its height at the next, and so on, as in `static-screen`.

    Two running means of the time are kept, over `tau_s` and over `smooth` times that.  The error is
    the target rate minus the smooth mean's rate, over the target; it is 0 where its square is below
    the variance, `kv` times the squared difference of the two means' rates, and rises to its full
    size at twice the variance.  It is clamped to ±1, so that with `kp` alone the angle moves by one
    degree a frame at most.

    Uses: work times of completed frames, the clock, and what `static-screen` uses.

    Parameters: as below.

    Cost per frame: O(n), one visit an object.

    Reference: LODManager of High Fidelity's interface (now Vircadia and Overte), whose target is a
    rate plus 5 Hz, and whose angle is the size below which things are left out.
    """

    kp: NotNegative = 1.0  # hifi's
    ki: NotNegative = 0.0  # hifi's
    kd: NotNegative = 0.0  # hifi's
    kv: NotNegative = 1.0  # hifi's
    tau_s: Positive = 0.08  # hifi's, seconds of the running mean
    smooth: AtLeastOne = 10.0  # hifi's
    offset_hz: NotNegative = 5.0  # hifi's, above the rate of the budget
    min_deg: Positive = 0.001  # hifi's
    max_deg: Annotated[float, Interval("(0, 180)")] = 90.0  # hifi's
    start_deg: float = 10.0  # ours
    ratio: Fraction = 0.5  # as static-screen
    hysteresis: NotNegative = 0.0  # hifi has none

    rising: ClassVar[tuple[str, ...]] = ("min_deg", "start_deg", "max_deg")
    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    # The rate aimed at: hifi has no share of the budget, and its angle goes wherever this leads.
    knob: ClassVar[Knob] = Knob("offset_hz", 1.0, 1000.0, finer="lower")

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start from the first angle, without a past."""
        check_parameters(self, "pid")
        self._static = StaticScreen(1.0, self.ratio, 1.0, self.hysteresis)
        self._static.reset(scene, budget_ms)
        self._target_hz = 1e3 / budget_ms + self.offset_hz
        self._angle_deg = self.start_deg
        self._now_ms = self._smooth_ms = math.nan
        self._error = self._integral = 0.0
        self._last_ns = 0
        self._reports = Reports()

    def select(self, view: View) -> Selection:
        """Steer the angle, then return a level for every candidate."""
        time_ms = self._reports.newest_ms(view, view.completed.work_ms, 1e3 / self._target_hz)
        if math.isfinite(time_ms):
            step_s = (view.time_ns - self._last_ns) * 1e-9
            self._last_ns = view.time_ns
            self._average(time_ms, step_s)
            self._steer(step_s)
        half_deg = 0.5 * self._angle_deg
        camera = view.camera
        height = math.tan(math.radians(half_deg)) * 2.0 * camera.focal_px / camera.height_px
        return self._static.select_biased(view, 1.0 / height)

    def _average(self, time_ms: float, step_s: float) -> None:
        if math.isnan(self._now_ms):
            self._now_ms = self._smooth_ms = time_ms
            return
        blend = min(step_s / self.tau_s, 1.0)
        self._now_ms += blend * (time_ms - self._now_ms)
        blend = min(step_s / (self.tau_s * self.smooth), 1.0)
        self._smooth_ms += blend * (time_ms - self._smooth_ms)

    def _steer(self, step_s: float) -> None:
        step_s = min(step_s, self.tau_s)
        if step_s <= 0.0:
            return
        error = self._gated_error()
        self._integral = min(max(self._integral + error * step_s, -1.0), 1.0)
        slope = (error - self._error) / step_s
        self._error = error
        output = self.kp * error + self.ki * self._integral + self.kd * slope
        self._angle_deg = min(max(self._angle_deg + output, self.min_deg), self.max_deg)

    def _gated_error(self) -> float:
        """Return the relative error of the smooth rate, less what the variance explains."""
        now_hz, smooth_hz = 1e3 / self._now_ms, 1e3 / self._smooth_ms
        error_hz = self._target_hz - smooth_hz
        variance = self.kv * (smooth_hz - now_hz) ** 2
        weight = 1.0
        if variance > 0.0:
            weight = min(max(error_hz * error_hz / variance - 1.0, 0.0), 1.0)
        return min(max(weight * error_hz / self._target_hz, -1.0), 1.0)
