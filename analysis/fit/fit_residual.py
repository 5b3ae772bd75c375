"""What a fit leaves unexplained, as the residual model of a profile."""

import numpy as np

from ...base.arrays import FloatArray
from ...models.machine.residual import Residual
from ...traces.logs.render_log import RenderLog
from .fit import Fit
from .noise import residual_model
from .paired_noise import paired_residual, pairs_of

_MEAN = 1e3  # milliseconds in a second


def residual_of(fit: Fit) -> Residual:
    """Return the residual model of a fit: in the order of drawing, and along the path.

    Of logs in which each frame was drawn twice, the machine's noise is what differs.
    """
    sample, logs = fit.estimate.sample, range(len(fit.sources))
    kind = "student-t" if fit.options.model == "student-t" else "gaussian"
    steps = [step_s(source.log, sample.time_ms) for source in fit.sources]
    series, step = relative_residuals(fit), float(np.median(steps))
    of_log = [sample.series == log for log in logs]
    paths = None if sample.path is None else [sample.path[which] for which in of_log]
    pairs = [pair for path in paths or () if (pair := pairs_of(path)) is not None]
    if len(pairs) == len(fit.sources):
        times_ms = [sample.time_ms[which] for which in of_log]
        return paired_residual(series, times_ms, pairs, step, kind)
    return residual_model(series, kind, step, paths)


def relative_residuals(fit: Fit) -> list[FloatArray]:
    """Return residuals over the mean time, a series of frames for each log.

    Where there are several logs, each is about its own level: occasions and scenes are no noise.
    """
    estimate = fit.estimate
    width = len(estimate.design.names)
    mean = estimate.design.mean(estimate.chain.flat[:, :width].mean(axis=0)[np.newaxis])[0]
    residual = estimate.sample.time_ms / mean - 1.0
    parts = [residual[estimate.sample.series == log] for log in range(len(fit.sources))]
    return parts if len(parts) == 1 else [(part - (m := part.mean())) / (1.0 + m) for part in parts]


def step_s(log: RenderLog, time_ms: FloatArray) -> float:
    """Return the seconds of the path from frame to frame, or of the log's clock, or of frames."""
    clock = log.recorded.get("trace_s", log.time_s)
    if clock is not None:
        steps = np.diff(clock)
        steps = steps[np.isfinite(steps) & (steps > 0.0)]
        if len(steps):
            return float(np.median(steps))
    return float(np.mean(time_ms)) / _MEAN
