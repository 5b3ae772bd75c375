"""Hardware profiles as TOML files, schema ``lodbench.hardware/1``: writing.

The same profile always gives the same text, and reading it back the same profile, bit for bit.
"""

import dataclasses
import json
import os
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, cast

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from .hardware import HardwareProfile, Posterior
from .profile_file import PER_MS, SCHEMA


def write_profile(profile: HardwareProfile, path: Path, comment: str = "") -> None:
    """Write a profile, all or nothing; `comment` lines stand on top after ``#``.

    Raises `InputError` if the file cannot be written.
    """
    temporary = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    try:
        temporary.write_bytes(profile_toml(profile, comment).encode("utf-8"))
        temporary.replace(path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        message = f"expected a writable path, got {error.strerror}; choose another"
        raise InputError(message, path=path) from error


def profile_toml(profile: HardwareProfile, comment: str = "") -> str:
    """Return the TOML text of a profile."""
    return "\n".join(_lines(profile, comment)) + "\n"


def _lines(profile: HardwareProfile, comment: str) -> Iterator[str]:
    yield from (f"# {line}".rstrip() for line in comment.splitlines())
    yield f"schema = {_text(SCHEMA)}"
    yield f"name = {_text(profile.name)}"
    yield f"frames_in_flight = {profile.frames_in_flight}"
    yield from _record("provenance", profile.provenance)
    deviation = _deviations(profile.posterior)
    gpu = profile.gpu
    yield from ("", "[gpu]", f"base = {_amount(gpu.base_ms, deviation.get('base', 0.0))}")
    yield from _terms("gpu.linear", GPU_PREDICTORS, gpu.linear_ms, deviation)
    yield from _terms(
        "gpu.roofline",
        GPU_PREDICTORS,
        gpu.roofline_ms,
        {name: deviation.get(f"roofline.{name}", 0.0) for name in GPU_PREDICTORS},
    )
    yield from _record("gpu.residual", profile.gpu_residual)
    if profile.posterior is not None:
        yield from _posterior(profile.posterior)
    yield from ("", "[cpu]", f"base = {_amount(profile.cpu.base_ms)}")
    yield from _terms("cpu.linear", CPU_PREDICTORS, profile.cpu.linear_ms, {})
    yield from _record("cpu.residual", profile.cpu_residual)
    yield from _record("display", profile.display)
    yield from ("", "[memory]", f"bytes = {_number(profile.memory_bytes)}")
    yield from ("", "[disk]", f"bytes_per_s = {_number(profile.disk_bytes_per_s)}")
    yield f"latency_ms = {_number(profile.disk_latency_ms)}"


def _record(table: str, record: Any) -> Iterator[str]:
    yield from ("", f"[{table}]")
    for item in dataclasses.fields(record):
        yield f"{item.name} = {_value(getattr(record, item.name))}"


def _terms(
    table: str, names: tuple[str, ...], values_ms: FloatArray, deviation: dict[str, float]
) -> Iterator[str]:
    if values_ms.any():
        yield from ("", f"[{table}]")
    for name, value in zip(names, values_ms.tolist(), strict=True):
        if value:
            yield f"{name} = {_amount(value, deviation.get(name, 0.0))}"


def _columns(posterior: Posterior) -> tuple[list[str], FloatArray]:
    """Return the terms that any draw has, base first, and their draws."""
    names, slopes = GPU_PREDICTORS, posterior.linear_ms
    if posterior.roofline_ms is not None:
        names = (*names, *(f"roofline.{name}" for name in GPU_PREDICTORS))
        slopes = np.hstack([slopes, posterior.roofline_ms])
    used = np.flatnonzero(slopes.any(axis=0))
    values = np.column_stack([posterior.base_ms, slopes[:, used]])
    return ["base", *(names[i] for i in used)], values


def _deviations(posterior: Posterior | None) -> dict[str, float]:
    if posterior is None or len(posterior) < 2:
        return {}
    terms, values = _columns(posterior)
    return dict(zip(terms, values.std(axis=0, ddof=1).tolist(), strict=True))


def _posterior(posterior: Posterior) -> Iterator[str]:
    terms, values = _columns(posterior)
    yield from ("", "[gpu.posterior]", f"terms = [{', '.join(map(_text, terms))}]", 'unit = "ms"')
    if len(posterior) > 1:
        covariance: FloatArray = np.atleast_2d(np.cov(values, rowvar=False))
        yield from _matrix("covariance", covariance)
    yield f"scale = {_row(posterior.scale.tolist())}"
    yield from _matrix("draws", values)


def _matrix(key: str, values: FloatArray) -> Iterator[str]:
    yield f"{key} = ["
    yield from (f"  {_row(row)}," for row in values.tolist())
    yield "]"


def _row(values: Iterable[float]) -> str:
    return f"[{', '.join(map(_number, values))}]"


def _amount(value_ms: float, sd_ms: float = 0.0) -> str:
    value, unit = _in_unit(value_ms)
    sd = f", sd = {sd_ms * PER_MS[unit]:.3g}" if sd_ms else ""
    return f'{{ value = {value}, unit = "{unit}"{sd} }}'


def _in_unit(value_ms: float) -> tuple[str, str]:
    """Return the shortest decimal and its unit that divide back to exactly `value_ms`."""
    best = _number(value_ms), "ms"
    for unit in ("us", "ns") if value_ms else ():
        near = value_ms * PER_MS[unit]
        for value in [float(f"{near:.{digits}g}") for digits in range(1, 18)]:
            if value / PER_MS[unit] == value_ms and len(_number(value)) < len(best[0]):
                best = _number(value), unit
    return best


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, tuple):
        return f"[{', '.join(map(_text, cast('tuple[str, ...]', value)))}]"
    return str(value) if isinstance(value, int) else _number(value)


def _number(value: float) -> str:
    return repr(float(value))


def _text(value: str) -> str:
    """Return a TOML basic string; JSON's escapes are TOML's, but for DEL."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
