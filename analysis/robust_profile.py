"""A hardware profile from render logs by robust non-negative least squares.

This is how the bundled profile ``llvmpipe`` was made; `docs/hardware.md` shows the call.  The
residual model and the draws come from the same frames: residuals of successive frames are
correlated, because what a linear model misses changes slowly with the view, so the residual model
is an autoregression of order 1 with Student's t innovations, and the draws refit whole blocks of
frames (moving-block bootstrap, Künsch 1989).
"""

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..models.arrays import FloatArray
from ..models.cost import CostModel, CpuCostModel
from ..models.hardware import Display, HardwareProfile, Posterior, Provenance
from ..models.predictors import GPU_PREDICTORS
from ..models.residual import Residual
from ..traces.renderlog import RenderLog, TimeName, measurable
from .robust_fit import RobustFit, robust_nnls

__all__ = ["file_sha256", "frames_of", "profile_from_logs", "residual_model"]

_DRAWS = 64
_BLOCK = 40  # frames; beyond it the residuals' autocorrelation in the logs at hand is under 0.6
_DIGITS = 4


def frames_of(
    log: RenderLog, terms: Sequence[str], target: TimeName
) -> tuple[FloatArray, FloatArray]:
    """Return predictors (n, P) and times (n,) of the frames that measure `target`."""
    keep, _ = measurable(log, target, terms)
    return log.columns(terms)[keep], log.time(target)[keep]


def profile_from_logs(
    logs: Sequence[RenderLog],
    terms: Sequence[str],
    rng: np.random.Generator,
    *,
    name: str,
    target: TimeName = "frame_ms",
    source: str = "",
    date: str = "",
) -> HardwareProfile:
    """Fit the logs together and return the profile, its numbers rounded to 4 digits.

    The whole of `target` becomes cost of the GPU; the CPU's cost is 0, "not measured", and one
    frame is in flight, so that no work is counted twice and none overlaps.

    Raises
    ------
    InputError
        If a log lacks a term or the target, or the frames are too few.
    """
    parts = [frames_of(log, terms, target) for log in logs]
    fit = robust_nnls(*_pooled(parts))
    residual = residual_model([fit.residuals(*part) for part in parts])
    resolution = dict(logs[0].header).get("resolution", "1280x720").split("x")
    return HardwareProfile(
        name=name,
        provenance=Provenance(
            source=source or ", ".join(log.name for log in logs),
            renderer=dict(logs[0].header).get("renderer", ""),
            date=date,
            method=f"robust non-negative least squares of {target} on {', '.join(terms)}",
        ),
        gpu=_cost_model(fit, terms),
        cpu=CpuCostModel.of(0.0, {}),
        gpu_residual=residual,
        posterior=_bootstrap(parts, terms, rng),
        display=Display(width_px=int(resolution[0]), height_px=int(resolution[1])),
        frames_in_flight=1,
    )


def _pooled(parts: Sequence[tuple[FloatArray, FloatArray]]) -> tuple[FloatArray, FloatArray]:
    return np.vstack([part[0] for part in parts]), np.concatenate([part[1] for part in parts])


def _cost_model(fit: RobustFit, terms: Sequence[str]) -> CostModel:
    slopes: Mapping[str, float] = dict(zip(terms, fit.slopes_ms.tolist(), strict=True))
    return CostModel.of(
        _rounded(fit.base_ms), {term: _rounded(slope) for term, slope in slopes.items()}
    )


def residual_model(series: Sequence[FloatArray]) -> Residual:
    """Return the residual model of relative residuals, one series of successive frames a log.

    The correlation is that of lag 1 over all series; degrees of freedom and scale are those of the
    innovations by maximum likelihood; the floor is the lowest factor seen, to a tenth.
    """
    from scipy import stats

    before = np.concatenate([part[:-1] for part in series])
    after = np.concatenate([part[1:] for part in series])
    correlation = float(np.clip((before @ after) / (before @ before), 0.0, 0.99))
    innovation = (after - correlation * before) / np.sqrt(1.0 - correlation**2)
    dof, _, scale = stats.t.fit(innovation, floc=0.0)
    lowest = 1.0 + min(float(part.min()) for part in series)
    return Residual(
        kind="student-t",
        scale=_rounded(float(scale)),
        dof=_rounded(float(np.clip(dof, 2.1, 100.0))),
        floor=float(np.clip(np.floor(10.0 * lowest) / 10.0, 0.0, 1.0)),
        correlation=_rounded(correlation),
    )


def _bootstrap(
    parts: Sequence[tuple[FloatArray, FloatArray]],
    terms: Sequence[str],
    rng: np.random.Generator,
) -> Posterior:
    linear = np.zeros((_DRAWS, len(GPU_PREDICTORS)))
    base, scale = np.zeros(_DRAWS), np.zeros(_DRAWS)
    columns = [GPU_PREDICTORS.index(term) for term in terms]
    for draw in range(_DRAWS):
        picks = [_blocks(len(part[1]), rng) for part in parts]
        sample = [(x[pick], y[pick]) for (x, y), pick in zip(parts, picks, strict=True)]
        fit = robust_nnls(*_pooled(sample))
        base[draw] = _rounded(fit.base_ms)
        scale[draw] = residual_model([fit.residuals(*part) for part in parts]).scale
        linear[draw, columns] = [_rounded(slope) for slope in fit.slopes_ms.tolist()]
    return Posterior(base, linear, scale)


def _blocks(count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Return indices of blocks of successive frames, drawn with replacement, `count` in all."""
    block = min(_BLOCK, count)
    starts = rng.integers(0, count - block + 1, size=-(-count // block))
    return (starts[:, np.newaxis] + np.arange(block)).ravel()[:count]


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


def file_sha256(path: Path) -> str:
    """Return the first 12 hexadecimal digits of a file's SHA-256, for a profile's source."""
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12]
