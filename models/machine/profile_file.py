"""Hardware profiles as TOML files, schema ``lodbench.hardware/1``: reading.

A coefficient is a value with its unit, so that a person reads ``70.5 ns`` a triangle and not
``7.05e-05``.  ``profile_writer`` is the inverse, bit for bit.
"""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np

from ...base.errors import InputError
from ...base.files.strict_toml import TomlDocument, read_toml
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from ...base.reader_guard import guarded
from .cost import CostModel, CpuCostModel
from .hardware import Display, HardwareProfile, Posterior, Provenance
from .identification import Identification
from .knee import Knee
from .residual import Residual
from .scatter import Scatter

SCHEMA = "lodbench.hardware/1"
PER_MS = {"ns": 1e6, "us": 1e3, "ms": 1.0}

_LARGEST_BYTES = 64 << 20  # a profile with 10,000 draws has 2 MB; more is another kind of file


@dataclass(frozen=True, slots=True)
class _Amount:
    """A time, or a time per unit of a predictor; `sd` informs people, the simulator takes draws."""

    value: float
    unit: Literal["ns", "us", "ms"]
    sd: float = 0.0


@dataclass(frozen=True, slots=True)
class _Knee:
    """A price of each unit of a frame beyond `at`."""

    predictor: str
    at: float
    value: float
    unit: Literal["ns", "us", "ms"]
    sd: float = 0.0


@dataclass(frozen=True, slots=True)
class _Draws:
    """Draws in milliseconds, one row each; `covariance` is theirs, for people and other tools."""

    terms: list[str]
    unit: Literal["ms"]
    draws: list[list[float]]
    scale: list[float]
    covariance: list[list[float]] = dataclasses.field(default_factory=list[list[float]])


@dataclass(frozen=True, slots=True)
class _Memory:
    bytes: float


@dataclass(frozen=True, slots=True)
class _Disk:
    bytes_per_s: float
    latency_ms: float


def read_profile(path: Path) -> HardwareProfile:
    """Read a hardware profile.

    Raises `InputError` if the file is absent, not UTF-8, not TOML, of another schema, or a table,
    key, unit or number in it is missing, unknown or out of range; with the line where that is
    known.
    """
    with guarded(path, "a hardware profile"):
        return _read(read_toml(path, _LARGEST_BYTES, "give a hardware profile in UTF-8"))


def parse_profile(text: str) -> HardwareProfile:
    """Return the profile that a TOML text describes; raises InputError as `read_profile`."""
    return _read(TomlDocument(text))


def _read(document: TomlDocument) -> HardwareProfile:
    data = document.content
    schema = data.get("schema")
    if schema != SCHEMA:
        document.fail("schema", f'expected "{SCHEMA}", got {schema!r}; is it a hardware profile?')
    sections = ("provenance", "gpu", "cpu", "display", "memory", "disk")
    known = ("schema", "name", "frames_in_flight", *sections, "identification")
    document.table(data, known, "")
    for key in ("name", *sections):
        if key not in data:
            document.fail("", f"expected the key {key}, found none; add it")
    return _profile(document, data)


def _profile(document: TomlDocument, data: dict[str, Any]) -> HardwareProfile:
    gpu = document.table(
        data["gpu"],
        ("base", "linear", "roofline", "knee", "residual", "scatter", "posterior"),
        "gpu",
    )
    cpu = document.table(data["cpu"], ("base", "linear", "residual"), "cpu")
    memory = document.record(data["memory"], _Memory, "memory")
    disk = document.record(data["disk"], _Disk, "disk")
    for where, table in (("gpu", gpu), ("cpu", cpu)):
        if "base" not in table:
            document.fail(where, "expected the key base, found none; add it")
    for key, kind in (("name", str), ("frames_in_flight", int)):
        if type(data.get(key, kind())) is not kind:
            document.fail(key, f"expected {kind.__name__}, got {data[key]!r}")
    posterior, told = gpu.get("posterior"), data.get("identification")
    knees = _knees(document, gpu.get("knee", []))
    try:
        return HardwareProfile(
            name=data["name"],
            provenance=document.record(data["provenance"], Provenance, "provenance"),
            gpu=CostModel.of(
                _amount_ms(document, gpu["base"], "gpu.base"),
                _terms_ms(document, gpu.get("linear", {}), GPU_PREDICTORS, "gpu.linear"),
                _terms_ms(document, gpu.get("roofline", {}), GPU_PREDICTORS, "gpu.roofline"),
                knees,
            ),
            cpu=CpuCostModel.of(
                _amount_ms(document, cpu["base"], "cpu.base"),
                _terms_ms(document, cpu.get("linear", {}), CPU_PREDICTORS, "cpu.linear"),
            ),
            gpu_residual=document.record(gpu.get("residual", {}), Residual, "gpu.residual"),
            cpu_residual=document.record(cpu.get("residual", {}), Residual, "cpu.residual"),
            posterior=None if posterior is None else _posterior(document, posterior, knees),
            display=document.record(data["display"], Display, "display"),
            frames_in_flight=data.get("frames_in_flight", 2),
            memory_bytes=memory.bytes,
            disk_bytes_per_s=disk.bytes_per_s,
            disk_latency_ms=disk.latency_ms,
            scatter=document.record(gpu.get("scatter", {}), Scatter, "gpu.scatter"),
            identification=(
                None if told is None else document.record(told, Identification, "identification")
            ),
        )
    except InputError as error:
        if error.line is not None:
            raise
        document.fail("", error.message)


def _amount_ms(document: TomlDocument, table: Any, where: str) -> float:
    """Return a non-negative time in milliseconds."""
    amount = document.record(table, _Amount, where)
    for name in ("value", "sd"):
        number = getattr(amount, name)
        if not (math.isfinite(number) and number >= 0.0):
            document.fail(f"{where}.{name}", f"expected a finite number >= 0, got {number}")
    return amount.value / PER_MS[amount.unit]


def _terms_ms(
    document: TomlDocument, table: Any, names: tuple[str, ...], where: str
) -> dict[str, float]:
    """Return coefficients in milliseconds per unit of each predictor given."""
    table = document.table(table, names, where)
    return {name: _amount_ms(document, item, f"{where}.{name}") for name, item in table.items()}


def _knees(document: TomlDocument, tables: Any) -> list[Knee]:
    """Return the knees of an array of tables."""
    if not isinstance(tables, list):
        document.fail("gpu.knee", "expected tables, each [[gpu.knee]]")
    knees: list[Knee] = []
    for at, table in enumerate(cast("list[Any]", tables)):
        where = f"gpu.knee.{at}"
        knee = document.record(table, _Knee, where)
        amount_ms = _amount_ms(
            document, {"value": knee.value, "unit": knee.unit, "sd": knee.sd}, where
        )
        try:
            found = Knee(knee.predictor, knee.at, amount_ms)
        except InputError as error:
            document.fail(where, error.message)
        if found.name in [knee.name for knee in knees]:
            document.fail(where, f"expected each knee once, got {found.name} again; leave one out")
        knees.append(found)
    return knees


def _posterior(document: TomlDocument, table: Any, knees: Sequence[Knee]) -> Posterior:
    where = "gpu.posterior"
    draws = document.record(table, _Draws, where)
    known = ("base", *GPU_PREDICTORS, *(f"roofline.{name}" for name in GPU_PREDICTORS))
    known += tuple(knee.name for knee in knees)
    document.table(dict.fromkeys(draws.terms), known, where)
    width = len(draws.terms)
    if "base" not in draws.terms or len(set(draws.terms)) != width:
        document.fail(f"{where}.terms", f"expected base and distinct predictors, got {draws.terms}")
    if {len(row) for row in draws.draws} != {width} or len(draws.scale) != len(draws.draws):
        message = f"expected rows of {width} values as in terms, and as many scales as rows"
        document.fail(f"{where}.draws", message)
    square = [len(row) for row in draws.covariance] == [width] * width
    if draws.covariance and not (square and np.isfinite(draws.covariance).all()):
        document.fail(f"{where}.covariance", f"expected {width} finite rows of {width}")
    columns = np.zeros((len(draws.draws), len(known)))
    columns[:, [known.index(term) for term in draws.terms]] = draws.draws
    try:
        width = len(GPU_PREDICTORS)
        base, linear, roofline, knee = np.split(columns, (1, 1 + width, 1 + 2 * width), axis=1)
        return Posterior(
            base[:, 0],
            linear,
            np.array(draws.scale),
            roofline if any(term.startswith("roofline.") for term in draws.terms) else None,
            knee if any(term.startswith("knee(") for term in draws.terms) else None,
        )
    except InputError as error:
        document.fail(where, error.message)
