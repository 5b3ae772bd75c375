"""Errors of frame times: of the model, of the simulated replay, and of the machine itself."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

import numpy as np

from ....base.arrays import FloatArray
from ....models.machine.hardware import HardwareProfile
from ...metrics.measured_frames import MeasuredFrames
from ..recorded_frames import Stretch
from ..validation_result import DetailError, Errors
from .time_errors import adapted_ms, at_nearest, at_times, summarise

_LEAST_SPREAD = 0.02
"""Of the share of detail: without one there is no slope."""


@dataclass(frozen=True, slots=True, eq=False)
class FrameErrors:
    """Predicted and measured times of the frames of one policy.

    Attributes
    ----------
    pairs : dict of str to (2, n) float64
        Predicted over measured, by the names of `Errors`.
    """

    pairs: dict[str, FloatArray]


def frame_errors(
    stretches: Sequence[Stretch],
    simulated: MeasuredFrames,
    hardware: HardwareProfile,
    usual_reference_ms: float | None = None,
) -> FrameErrors:
    """Return what is predicted of the frames of the first recording, and what was measured.

    Parameters
    ----------
    usual_reference_ms
        If given, times are divided by those of the reference drawing over this one: the drift of
        the machine, which no model of what is drawn can know.
    """
    first, *others = stretches
    model_ms = hardware.gpu.counted_ms(first.measured.counts)
    all_ms = np.asarray(first.measured.frames["gpu_ms"]) / _slowness(first, usual_reference_ms)
    work_ms = first.run.work_ms / _slowness(first, usual_reference_ms)[first.inside]
    time_s = first.run.time_s
    predicted = {
        "model": model_ms[first.inside],
        "v_time": adapted_ms(model_ms, all_ms)[first.inside],
        "simulation": at_times(simulated.time_s, simulated.work_ms, time_s),
    }
    for other in others[:1]:
        their_ms = other.run.work_ms / _slowness(other, usual_reference_ms)[other.inside]
        predicted["again"] = at_times(other.run.time_s, their_ms, time_s)
        # What the second recording took for what it drew, times what the first drew.
        ratio = their_ms / hardware.gpu.counted_ms(other.measured.counts)[other.inside]
        predicted["repeat"] = predicted["model"] * at_nearest(other.run.time_s, ratio, time_s)
    return FrameErrors({name: np.stack((ms, work_ms)) for name, ms in predicted.items()})


def _slowness(stretch: Stretch, usual_reference_ms: float | None) -> FloatArray:
    """Return how slow the machine was at each frame of a recording, 1 where nobody asks."""
    reference_ms = stretch.measured.reference_ms
    if usual_reference_ms is None or reference_ms is None:
        return np.ones(len(stretch.measured.frames))
    return reference_ms / usual_reference_ms


def summarise_all(parts: Sequence[FrameErrors]) -> Errors | None:
    """Return the errors of the frames of all parts together; None of no part.

    Raises `InputError` if there are fewer than two frames.
    """
    if not parts:
        return None
    names = [name for name in parts[0].pairs if all(name in part.pairs for part in parts)]
    found = {name: summarise(*np.hstack([part.pairs[name] for part in parts])) for name in names}
    repeat = found.get("repeat")
    noise_pct = None if repeat is None else repeat.sd_pct / sqrt(2.0)
    excess = found["model"].sd_pct / noise_pct if noise_pct else None
    return Errors(**found, noise_pct=noise_pct, excess=excess)


def detail_error(errors: FrameErrors, share: FloatArray) -> DetailError | None:
    """Return how the model's error goes with the share of full detail drawn, (n,) in [0, 1].

    None where fewer than eight frames have both.
    """
    predicted, measured = errors.pairs["model"]
    error = 100.0 * (predicted / measured - 1.0)
    known = np.isfinite(error) & np.isfinite(share)
    share, error = np.minimum(share[known], 1.0), error[known]
    if len(share) < 8:
        return None
    low, high = np.quantile(share, (0.05, 0.95)).tolist()
    order = np.argsort(share, kind="stable")
    a, b, c, d = (float(part.mean()) for part in np.array_split(error[order], 4))
    slope = None
    if high - low > _LEAST_SPREAD:
        off = share - share.mean()
        slope = float((off * error).sum() / (off**2).sum())
    return DetailError((low, high), slope, (a, b, c, d))


def cost_ratio(errors: FrameErrors) -> float | None:
    """Return the median of measured over predicted time of a frame; None where all cost nothing."""
    predicted, measured = errors.pairs["model"]
    priced = predicted > 0.0
    return float(np.median(measured[priced] / predicted[priced])) if priced.any() else None
