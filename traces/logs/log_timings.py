"""Frame timings of PresentMon, OCAT and CapFrameX as a render log without predictors."""

import numpy as np

from ...base.arrays import FloatArray
from .render_log import RenderLog
from .timings import FrameTimings


def log_from_timings(timings: FrameTimings, name: str) -> RenderLog:
    """Return the times of a stream of frames as a log: CPU and GPU are their busy times.

    ``frame_ms`` is from one start on the CPU to the next, or between presents where the file has
    no more.
    """
    frame_ms = _if_any(timings.frame_ms)
    source = "from CPU start to CPU start"
    if frame_ms is None:
        frame_ms, source = _if_any(timings.between_presents_ms), "between presents"
    return RenderLog(
        name=name,
        format=timings.dialect,
        predictors=(),
        counts=np.empty((len(timings), 0)),
        frame_ms=frame_ms,
        gpu_ms=_if_any(timings.gpu_busy_ms),
        cpu_ms=_if_any(timings.cpu_busy_ms),
        time_s=timings.present_s,
        header=timings.header,
        notes=(*timings.notes, f"frame_ms is {source}"),
    )


def _if_any(values: FloatArray) -> FloatArray | None:
    return values if np.isfinite(values).any() else None
