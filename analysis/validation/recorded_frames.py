"""Recordings as a validation takes them: frames, counts under names of the cost model, reference.

The reference is a drawing that never changes, made before and after each frame: where it takes
longer, the machine is slower at that moment, whatever is drawn.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...sim.frame_log import FrameLog
from ..fit.drift import running_reference_ms
from ..metrics.measured_frames import MeasuredFrames
from ..metrics.metric_registry import METRICS
from ..metrics.over_time import time_mean, time_quantile
from .recordings import Recorded
from .validation_result import Drift


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """One recording.

    Attributes
    ----------
    frames : FrameLog
    counts : dict of str to (n,) float64
        What was drawn, by GPU predictor; ``shaded_samples`` as the simulator counts them.
    reference_ms : (n,) float64 or None
        Time of the reference drawing about each frame, as a fit takes it too.
    lag_ms : (n,) float64 or None
        From the frame's input sample until the device was done with it, where that was measured.
    prepare_ms, submit_ms : (n,) float64 or None
        From there until the frame was ready to submit, and for its submission, where frames are
        drawn deep.
    """

    frames: FrameLog
    counts: Mapping[str, FloatArray]
    reference_ms: FloatArray | None = None
    lag_ms: FloatArray | None = None
    prepare_ms: FloatArray | None = None
    submit_ms: FloatArray | None = None


def measured_of(recorded: Recorded) -> Measured:
    """Return a recording with its counts under the names of the cost model."""
    columns = recorded.columns
    return Measured(
        recorded.frames,
        columns | {"shaded_samples": columns["projected_px"]},
        running_reference_ms(columns),
        columns.get("lag_ms"),
        columns.get("prepare_ms"),
        columns["cpu_ms"] if "prepare_ms" in columns else None,
    )


def frames_in_flight(header: Mapping[str, str]) -> int:
    """Return how many frames were drawn deep, as the header of a render log says it.

    Raises `InputError` if it says no number.
    """
    text = header.get("frames_in_flight", "1")
    if not text.isdecimal():
        message = f"expected a number of frames in flight in its header, got {text}"
        raise InputError(f"recording: {message}; record again")
    return int(text)


def usual_reference_ms(recordings: Sequence[Measured]) -> float | None:
    """Return the median time of the reference drawing over all recordings, None without one.

    It is common to them: what one policy's recording has on top of another's is divided out too.
    """
    known = [item.reference_ms for item in recordings if item.reference_ms is not None]
    if not known or len(known) < len(recordings):
        return None
    return float(np.median(np.concatenate(known)))


def drift_of(recordings: Sequence[Measured]) -> Drift | None:
    """Return how the reference drawing's time changed over recordings, None without one."""
    usual_ms = usual_reference_ms(recordings)
    if usual_ms is None:
        return None
    times = [item.reference_ms for item in recordings if item.reference_ms is not None]
    change = 100.0 * (np.concatenate(times) / usual_ms - 1.0)
    low, high = np.quantile(change, (0.05, 0.95)).tolist()
    return Drift(float(change.std(ddof=1)), low, high)


@dataclass(frozen=True, slots=True, eq=False)
class Stretch:
    """The frames of a recording that count, and what is said of them.

    Attributes
    ----------
    measured : Measured
    run : MeasuredFrames
    """

    measured: Measured
    run: MeasuredFrames

    @property
    def inside(self) -> slice:
        """Where the frames lie in the recording."""
        return slice(self.run.first, self.run.first + len(self.run))

    def count(self, name: str) -> FloatArray:
        """Return a count of each frame."""
        return np.asarray(self.measured.counts[name])[self.inside]

    def judged_ms(self, miss: float) -> float:
        """Return the work time by which the budget is judged, its quantile over time."""
        found = time_quantile(self.run.work_ms, self.run.cost_weight_ms, 1.0 - miss)
        return float(self.run.work_ms.max()) if found is None else found

    def values(self) -> dict[str, float | None]:
        """Return every metric by id; lag as it was measured, where it was."""
        values = {metric.id: metric(self.run) for metric in METRICS}
        if self.measured.lag_ms is not None:
            lag_ms, weight_ms = self.measured.lag_ms[self.inside], self.run.cost_weight_ms
            values["lag_ms_mean"] = time_mean(lag_ms, weight_ms)
            values["lag_ms_p99"] = time_quantile(lag_ms, weight_ms, 0.99)
        return values


def stretch_of(measured: Measured, window_s: tuple[float, float]) -> Stretch:
    """Return the frames that count; raises `InputError` if there are none."""
    return Stretch(measured, MeasuredFrames(measured.frames, *window_s))
