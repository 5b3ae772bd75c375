"""Frame timings of PresentMon, OCAT and CapFrameX as a render log without predictors."""

import numpy as np

from ...base.arrays import FloatArray
from .render_log import ColumnSource, RenderLog
from .timings import FrameTimings


def log_from_timings(timings: FrameTimings, name: str) -> RenderLog:
    """Return the times of a stream of frames as a log: CPU and GPU are their busy times.

    ``frame_ms`` is from one start on the CPU to the next where the tool measured it, else between
    presents, as version 1, OCAT, CapFrameX and FrameView have it.
    """
    frame_ms, between_ms = timings.frame_ms, timings.between_presents_ms
    source = "from CPU start to CPU start"
    if np.isnan(frame_ms).sum() > np.isnan(between_ms).sum():
        frame_ms, source = between_ms, "between presents"
    columns = {
        "frame_ms": (_if_any(frame_ms), source),
        "gpu_ms": (_if_any(timings.gpu_busy_ms), "time in which the GPU was busy"),
        "cpu_ms": (_if_any(timings.cpu_busy_ms), "from CPU start to Present()"),
    }
    return RenderLog(
        name=name,
        format=timings.dialect,
        predictors=(),
        counts=np.empty((len(timings), 0)),
        frame_ms=columns["frame_ms"][0],
        gpu_ms=columns["gpu_ms"][0],
        cpu_ms=columns["cpu_ms"][0],
        time_s=timings.present_s,
        header=timings.header,
        notes=(*timings.notes, f"frame_ms is {source}"),
        sources=tuple(
            ColumnSource(name, text, "ms")
            for name, (time, text) in columns.items()
            if time is not None
        ),
        timings=timings,
    )


def _if_any(values: FloatArray) -> FloatArray | None:
    return values if np.isfinite(values).any() else None
