"""The moment of a run in which most work was done, and which cost had grown."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from ...models.machine.hardware import HardwareProfile
from ...sim.frame_log import UNLOGGED
from .measured_frames import MeasuredFrames


@dataclass(frozen=True, slots=True)
class Moment:
    """The frame of a run with the largest work time.

    Attributes
    ----------
    path : str
    time_s : float
        When its camera was sampled, by the clock of the path.
    camera_m : (x, y, z)
    work_ms : float
    usual_ms : float
        Median of the run.
    term : str
        The predictor whose cost had grown most against its median; empty if none had.
    grown_ms : float
        By how much.
    """

    path: str
    time_s: float
    camera_m: tuple[float, float, float]
    work_ms: float
    usual_ms: float
    term: str
    grown_ms: float


def find_worst_moment(frames: MeasuredFrames, hardware: HardwareProfile) -> Moment:
    """Return the moment of most work in the window of a run."""
    work_ms = frames.work_ms
    at = int(work_ms.argmax())
    term, grown_ms = _grown_term(frames, at, hardware)
    x, y, z = (float(frames[axis][at]) for axis in ("x_m", "y_m", "z_m"))
    return Moment(
        path=frames.header.trace,
        time_s=float(frames.time_s[at]),
        camera_m=(x, y, z),
        work_ms=float(work_ms[at]),
        usual_ms=float(np.median(work_ms)),
        term=term,
        grown_ms=grown_ms,
    )


def _grown_term(frames: MeasuredFrames, at: int, hardware: HardwareProfile) -> tuple[str, float]:
    """Return the predictor of the side that took longer whose cost is most above its median's.

    What it costs is its linear price and its knees.
    """
    if frames["gpu_ms"][at] >= frames["cpu_ms"][at]:
        names, unit_ms, knees = GPU_PREDICTORS, hardware.gpu.linear_ms, hardware.gpu.knees
    else:
        names, unit_ms, knees = CPU_PREDICTORS, hardware.cpu.linear_ms, ()
    grown = {
        name: ms * _above_median(frames[name], at)
        for name, ms in zip(names, unit_ms.tolist(), strict=True)
        if ms > 0.0 and name not in UNLOGGED
    }
    for knee in knees:
        if knee.predictor not in UNLOGGED:
            counts = frames[knee.predictor]
            then, usual = (knee.frame_ms(float(x)) for x in (counts[at], np.median(counts)))
            grown[knee.predictor] = grown.get(knee.predictor, 0.0) + then - usual
    term = max(grown, key=grown.__getitem__, default="")
    return (term, grown[term]) if term and grown[term] > 0.0 else ("", 0.0)


def _above_median(counts: FloatArray, at: int) -> float:
    return float(counts[at] - np.median(counts))
