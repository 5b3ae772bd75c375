"""Hardware profiles as TOML files, schema ``lodbench.hardware/1``: writing.

The same profile always gives the same text, and reading it back the same profile, bit for bit.
"""

import dataclasses
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from ...base.arrays import FloatArray
from ...base.files.whole_file import write_whole
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from .hardware import HardwareProfile, Posterior
from .knee import Knee
from .profile_file import PER_MS, SCHEMA
from .residual import Residual
from .scatter import Scatter

_Table = dict[str, Any]
_LATER = ("slow_", "spike_")  # keys of a residual that are newer than the schema


def write_profile(profile: HardwareProfile, path: Path) -> None:
    """Write a profile as `write_whole` does, which may raise its errors."""
    write_whole(path, profile_toml(profile))


def profile_toml(profile: HardwareProfile) -> str:
    """Return the TOML text of a profile."""
    terms, draws = _columns(profile.posterior, profile.gpu.knees)
    spread = draws.std(axis=0, ddof=1).tolist() if len(draws) > 1 else [0.0] * len(terms)
    deviation: dict[str, float] = dict(zip(terms, spread, strict=True))
    of_roofline = {name: deviation.get(f"roofline.{name}", 0.0) for name in GPU_PREDICTORS}
    gpu, cpu = profile.gpu, profile.cpu
    document: _Table = {
        "schema": SCHEMA,
        "name": profile.name,
        "frames_in_flight": profile.frames_in_flight,
        "provenance": dataclasses.asdict(profile.provenance),
        "gpu": {
            "base": _amount(gpu.base_ms, deviation.get("base", 0.0)),
            "linear": _terms(GPU_PREDICTORS, gpu.linear_ms, deviation),
            "roofline": _terms(GPU_PREDICTORS, gpu.roofline_ms, of_roofline),
            "knee": [_knee(knee, deviation.get(knee.name, 0.0)) for knee in gpu.knees],
            "residual": _residual(profile.gpu_residual),
            "scatter": _scatter(profile.scatter),
        },
        "cpu": {
            "base": _amount(cpu.base_ms),
            "linear": _terms(CPU_PREDICTORS, cpu.linear_ms, {}),
            "residual": _residual(profile.cpu_residual),
        },
        "display": dataclasses.asdict(profile.display),
        "memory": {"bytes": float(profile.memory_bytes)},
        "disk": {
            "bytes_per_s": float(profile.disk_bytes_per_s),
            "latency_ms": float(profile.disk_latency_ms),
        },
    }
    if profile.posterior is not None:
        document["gpu"]["posterior"] = _posterior(terms, draws, profile.posterior.scale)
    if profile.identification is not None:
        document["identification"] = dataclasses.asdict(profile.identification)
    for part in ("gpu", "cpu"):
        document[part] = {key: table for key, table in document[part].items() if table}
    return tomli_w.dumps(document)


def _columns(posterior: Posterior | None, knees: Sequence[Knee]) -> tuple[list[str], FloatArray]:
    """Return the terms that any draw has, base first, and their draws."""
    if posterior is None:
        return [], np.zeros((0, 0))
    names, slopes = GPU_PREDICTORS, posterior.linear_ms
    if posterior.roofline_ms is not None:
        names = (*names, *(f"roofline.{name}" for name in GPU_PREDICTORS))
        slopes = np.hstack([slopes, posterior.roofline_ms])
    if posterior.knee_ms is not None:
        names = (*names, *(knee.name for knee in knees))
        slopes = np.hstack([slopes, posterior.knee_ms])
    used = np.flatnonzero(slopes.any(axis=0))
    terms = ["base", *(names[i] for i in used)]
    return terms, np.column_stack([posterior.base_ms, slopes[:, used]])


def _residual(residual: Residual) -> _Table:
    """Return a residual as a table, without keys of a later version that say nothing."""
    table, plain = dataclasses.asdict(residual), dataclasses.asdict(Residual())
    silent = [key for key in table if key.startswith(_LATER) and table[key] == plain[key]]
    return {key: value for key, value in table.items() if key not in silent}


def _scatter(scatter: Scatter) -> _Table:
    return {} if scatter == Scatter() else dataclasses.asdict(scatter)


def _knee(knee: Knee, sd_ms: float) -> _Table:
    return {"predictor": knee.predictor, "at": float(knee.at), **_amount(knee.ms, sd_ms)}


def _posterior(terms: list[str], draws: FloatArray, scale: FloatArray) -> _Table:
    table: _Table = {"terms": terms, "unit": "ms"}
    if len(draws) > 1:
        table["covariance"] = np.atleast_2d(np.cov(draws, rowvar=False)).tolist()
    return table | {"scale": scale.tolist(), "draws": draws.tolist()}


def _terms(names: Iterable[str], values_ms: FloatArray, deviation: dict[str, float]) -> _Table:
    return {
        name: _amount(value, deviation.get(name, 0.0))
        for name, value in zip(names, values_ms.tolist(), strict=True)
        if value
    }


def _amount(value_ms: float, sd_ms: float = 0.0) -> _Table:
    value, unit = _in_unit(value_ms)
    sd = {"sd": float(f"{sd_ms * PER_MS[unit]:.3g}")} if sd_ms else {}
    return {"value": value, "unit": unit, **sd}


def _in_unit(value_ms: float) -> tuple[float, str]:
    """Return the shortest decimal and its unit that divide back to exactly `value_ms`."""
    best = float(value_ms), "ms"
    for unit in ("us", "ns") if value_ms else ():
        near = value_ms * PER_MS[unit]
        for value in [float(f"{near:.{digits}g}") for digits in range(1, 18)]:
            if value / PER_MS[unit] == value_ms and len(repr(value)) < len(repr(best[0])):
                best = value, unit
    return best
