"""Hardware profiles as TOML files, schema ``lodbench.hardware/1``: reading.

A coefficient is a value with its unit, so that a person reads ``70.5 ns`` a triangle and not
``7.05e-05``.  ``profile_writer`` is the inverse, bit for bit.
"""

import dataclasses
import difflib
import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NoReturn, TypeVar, cast

import msgspec
import numpy as np

from ...base.errors import InputError
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from .cost import CostModel, CpuCostModel
from .hardware import Display, HardwareProfile, Posterior, Provenance
from .residual import Residual

SCHEMA = "lodbench.hardware/1"
PER_MS = {"ns": 1e6, "us": 1e3, "ms": 1.0}

_LARGEST_BYTES = 64 << 20  # a profile with 10,000 draws has 2 MB; more is another kind of file

Record = TypeVar("Record")


@dataclass(frozen=True, slots=True)
class _Amount:
    """A time, or a time per unit of a predictor; `sd` informs people, the simulator takes draws."""

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


@dataclass(frozen=True, slots=True)
class _Document:
    """The text of a profile, which knows on which line a key stands."""

    path: Path | None
    text: str

    def fail(self, where: str, message: str) -> NoReturn:
        """Raise InputError about the key or table `where`, such as ``gpu.linear.triangles``."""
        named = not where or message.startswith(where.rpartition(".")[2])
        label = "" if named else f"{where}: "
        raise InputError(label + message, path=self.path, line=self._line(where))

    def _line(self, where: str) -> int | None:
        """Return the line of the deepest part of `where` that the text holds, if any."""
        wanted, table = where.split("."), list[str]()
        depth, line_found = 0, None
        for number, line in enumerate(self.text.split("\n"), 1):
            header = re.match(r"\s*\[([^\[\]]+)\]", line)
            key = re.match(r"\s*([\w.-]+)\s*=", line)
            if header:
                table = header[1].replace(" ", "").split(".")
            names = [*table, *(key[1].split(".") if key and not header else ())]
            if len(names) > depth and names == wanted[: len(names)]:
                depth, line_found = len(names), number
        return line_found

    def known(self, table: Any, keys: Iterable[str], where: str) -> Mapping[str, Any]:
        """Return `table`, checked to be a table that has no other keys than these."""
        if not isinstance(table, dict):
            self.fail(where, f"expected a table, got {type(table).__name__}")
        keys = list(keys)
        for key in cast("dict[str, Any]", table):
            if key not in keys:
                near = difflib.get_close_matches(key, keys, n=1)
                hint = f"; did you mean {near[0]}?" if near else ""
                full = f"{where}.{key}".lstrip(".")
                self.fail(full, f"expected one of {', '.join(keys)}, got {key}{hint}")
        return cast("dict[str, Any]", table)

    def record(self, table: Any, kind: type[Record], where: str) -> Record:
        """Return a table as a dataclass with the same keys."""
        names = [item.name for item in dataclasses.fields(cast("Any", kind))]
        table = self.known(table, names, where)
        try:
            return msgspec.convert(table, kind)
        except msgspec.ValidationError as error:
            what, _, at = str(error).partition(" - at `$")
            key = re.sub(r"\[.*", "", at.rstrip("`"))
            missing = re.fullmatch(r"Object missing required field `(\w+)`", what)
            if missing:
                self.fail(where, f"expected the key {missing[1]}, found none; add it")
            what = what.replace("`", "")
            enum = re.match(r"Invalid enum value '(.*)'", what)
            if enum:
                what = f"expected one of {_choices(kind, key[1:])}, got {enum[1]}"
            self.fail(where + key, what[0].lower() + what[1:])
        except InputError as error:
            self.fail(where, error.message)

    def amount_ms(self, table: Any, where: str) -> float:
        """Return a non-negative time in milliseconds."""
        amount = self.record(table, _Amount, where)
        for name in ("value", "sd"):
            number = getattr(amount, name)
            if not (math.isfinite(number) and number >= 0.0):
                self.fail(f"{where}.{name}", f"expected a finite number >= 0, got {number}")
        return amount.value / PER_MS[amount.unit]

    def terms_ms(self, table: Any, names: tuple[str, ...], where: str) -> dict[str, float]:
        """Return coefficients in milliseconds per unit of each predictor given."""
        table = self.known(table, names, where)
        return {name: self.amount_ms(item, f"{where}.{name}") for name, item in table.items()}


def _choices(kind: type[Any], key: str) -> str:
    hint = next(item.type for item in dataclasses.fields(kind) if item.name == key)
    return ", ".join(str(choice) for choice in cast("Any", hint).__args__)


def read_profile(path: Path) -> HardwareProfile:
    """Read a hardware profile.

    Raises `InputError` if the file is absent, not UTF-8, not TOML, of another schema, or a table,
    key, unit or number in it is missing, unknown or out of range; with the line where that is
    known.
    """
    try:
        if path.stat().st_size > _LARGEST_BYTES:
            raise InputError("expected a hardware profile of at most 64 MiB", path=path)
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        message = f"expected a readable hardware profile, got {error.strerror}; give a .toml file"
        raise InputError(message, path=path) from error
    except UnicodeDecodeError as error:
        message = f"expected UTF-8 text, got byte 0x{error.object[error.start]:02x} at offset "
        raise InputError(f"{message}{error.start}; save the profile as UTF-8", path=path) from error
    return parse_profile(text, path)


def parse_profile(text: str, path: Path | None = None) -> HardwareProfile:
    """Return the profile that a TOML text describes; raises InputError as `read_profile`."""
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        at = re.search(r"\(at line (\d+), column \d+\)", str(error))
        line = int(at[1]) if at else None
        what = re.sub(r" \(at .*\)", "", str(error))
        raise InputError(f"expected TOML, got: {what}", path=path, line=line) from error
    except RecursionError as error:
        raise InputError("expected TOML, got brackets nested too deep", path=path) from error
    document = _Document(path, text)
    schema = data.get("schema")
    if schema != SCHEMA:
        document.fail("schema", f'expected "{SCHEMA}", got {schema!r}; is it a hardware profile?')
    sections = ("provenance", "gpu", "cpu", "display", "memory", "disk")
    document.known(data, ("schema", "name", "frames_in_flight", *sections), "")
    for key in ("name", *sections):
        if key not in data:
            document.fail("", f"expected the key {key}, found none; add it")
    return _profile(document, data)


def _profile(document: _Document, data: dict[str, Any]) -> HardwareProfile:
    gpu = document.known(
        data["gpu"], ("base", "linear", "roofline", "residual", "posterior"), "gpu"
    )
    cpu = document.known(data["cpu"], ("base", "linear", "residual"), "cpu")
    memory = document.record(data["memory"], _Memory, "memory")
    disk = document.record(data["disk"], _Disk, "disk")
    for where, table in (("gpu", gpu), ("cpu", cpu)):
        if "base" not in table:
            document.fail(where, "expected the key base, found none; add it")
    for key, kind in (("name", str), ("frames_in_flight", int)):
        if type(data.get(key, kind())) is not kind:
            document.fail(key, f"expected {kind.__name__}, got {data[key]!r}")
    posterior = gpu.get("posterior")
    try:
        return HardwareProfile(
            name=data["name"],
            provenance=document.record(data["provenance"], Provenance, "provenance"),
            gpu=CostModel.of(
                document.amount_ms(gpu["base"], "gpu.base"),
                document.terms_ms(gpu.get("linear", {}), GPU_PREDICTORS, "gpu.linear"),
                document.terms_ms(gpu.get("roofline", {}), GPU_PREDICTORS, "gpu.roofline"),
            ),
            cpu=CpuCostModel.of(
                document.amount_ms(cpu["base"], "cpu.base"),
                document.terms_ms(cpu.get("linear", {}), CPU_PREDICTORS, "cpu.linear"),
            ),
            gpu_residual=document.record(gpu.get("residual", {}), Residual, "gpu.residual"),
            cpu_residual=document.record(cpu.get("residual", {}), Residual, "cpu.residual"),
            posterior=None if posterior is None else _posterior(document, posterior),
            display=document.record(data["display"], Display, "display"),
            frames_in_flight=data.get("frames_in_flight", 2),
            memory_bytes=memory.bytes,
            disk_bytes_per_s=disk.bytes_per_s,
            disk_latency_ms=disk.latency_ms,
        )
    except InputError as error:
        if error.line is not None:
            raise
        document.fail("", error.message)


def _posterior(document: _Document, table: Any) -> Posterior:
    where = "gpu.posterior"
    draws = document.record(table, _Draws, where)
    known = ("base", *GPU_PREDICTORS, *(f"roofline.{name}" for name in GPU_PREDICTORS))
    document.known(dict.fromkeys(draws.terms), known, where)
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
        linear, roofline = np.split(columns[:, 1:], 2, axis=1)
        drawn = roofline if any(term.startswith("roofline.") for term in draws.terms) else None
        return Posterior(columns[:, 0], linear, np.array(draws.scale), drawn)
    except InputError as error:
        document.fail(where, error.message)
