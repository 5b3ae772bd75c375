"""The HLOD thesis' v_time for any policy that predicts: measured over predicted time, followed."""

from ...view import View
from .reports import Reports


class VTime:
    """A factor on predicted times that follows what completed frames took.

    Each believable report moves `factor` by `rate` of the way to measured over predicted time of
    its frame; a rate of 0 leaves it at 1.  The thesis says that v_time is adjusted by comparing the
    two and not how; the exponential average is ours.  Reports come as late as the pipeline delivers
    them, so a rate near 1 swings.

    Attributes
    ----------
    factor : float
    """

    def __init__(self, rate: float) -> None:
        self.factor = 1.0
        self._rate = rate
        self._reports = Reports()
        self._predicted_ms: list[float] = []

    def budget_ms(self, view: View, budget_ms: float) -> float:
        """Learn from new reports; return what the cost model may spend to keep the budget."""
        if self._rate > 0.0:
            frames, times_ms = self._reports.new(view, view.completed.gpu_ms, budget_ms)
            for frame, time_ms in zip(frames, times_ms, strict=True):
                ratio = float(time_ms) / max(self._predicted_ms[int(frame)], 1e-9)
                self.factor += self._rate * (ratio - self.factor)
        return budget_ms / self.factor

    def expect(self, predicted_ms: float) -> float:
        """Note what the cost model predicts of this frame; return what it should take."""
        if self._rate > 0.0:
            self._predicted_ms.append(predicted_ms)
        return predicted_ms * self.factor
