"""Where objects stand, from a file that an engine or a script exported.

CSV with a header, or JSON: a list of records, or ``{"instances": [...]}``.  A record has the name
of its mesh in ``type``, its place in ``x``, ``y``, ``z`` (or a list ``position``), and may have a
turn, either ``qx``, ``qy``, ``qz``, ``qw`` (or a list ``rotation``) or ``yaw_deg`` about the up
axis, a ``scale`` and an ``importance``.  Axes and unit are those of the meshes.
"""

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.errors import InputError
from ...base.files.strict_json import decode_json
from ...base.files.text_file import read_text
from ...base.foreign_text import one_line
from ...base.nearest_names import unknown_name
from ...base.reader_guard import guarded

_PLACE, _TURN = ("x", "y", "z"), ("qx", "qy", "qz", "qw")
_LISTS = {"position": _PLACE, "rotation": _TURN}
_OTHERS = ("yaw_deg", "scale", "importance")
_NAMES = ("type", "mesh", "name")
_KNOWN = {*_NAMES, *_PLACE, *_TURN, *_OTHERS}
_MOST = 10_000_000
_MOST_UNUSED = 50
_NORM = 0.1


@dataclass(frozen=True, slots=True)
class _Instances:
    instances: list[dict[str, Any]]


@dataclass(frozen=True, slots=True)
class Placements:
    """Where n objects stand, in the axes of the scene.

    Attributes
    ----------
    type_index : (n,) int
    position_m : (n, 3)
    turn_xyzw : (n, 4)
        Unit quaternions.
    scale, importance : (n,)
    unused : tuple of str
        Columns, or keys of records, of which nothing is known.
    """

    type_index: IntArray
    position_m: FloatArray
    turn_xyzw: FloatArray
    scale: FloatArray
    importance: FloatArray
    unused: tuple[str, ...] = ()


def read_placements(
    path: Path, types: Sequence[str], *, y_up: bool, unit_m: float = 1.0
) -> Placements:
    """Return the placements of a file.

    Raises `InputError` with the line (of JSON, the record) if one has no place, names no type, or
    has a number that cannot be.

    Parameters
    ----------
    types
        Names of the meshes.
    y_up, unit_m
        Axes and unit of the file.
    """
    with guarded(path, "places of objects", "export them again"):
        return _read(path, types, y_up=y_up, unit_m=unit_m)


def _read(path: Path, types: Sequence[str], *, y_up: bool, unit_m: float) -> Placements:
    kinds: list[int] = []
    rows: list[list[float]] = []
    unused: dict[str, None] = {}
    for line, record in _records(path):
        if len(rows) >= _MOST:
            raise InputError(f"expected at most {_MOST:,} objects, got more", path=path)
        kinds.append(_kind(record, types, path, line))
        rows.append(_numbers(record, path, line))
        if len(unused) < _MOST_UNUSED:
            unused |= dict.fromkeys(name for name in record if name not in _KNOWN)
    if not rows:
        raise InputError("expected an object, got none", path=path)
    table = np.array(rows)
    position = table[:, :3] * unit_m
    turn = table[:, 3:7] / np.linalg.norm(table[:, 3:7], axis=1, keepdims=True)
    yaw_rad = np.radians(table[:, 7])
    up = 1 if y_up else 2  # the axis about which a yaw turns, in the file
    about = np.zeros_like(turn)
    about[:, up], about[:, 3] = np.sin(yaw_rad / 2.0), np.cos(yaw_rad / 2.0)
    yawed = table[:, 7] != 0.0
    turn[yawed] = about[yawed]
    if y_up:
        # A quarter turn about x takes y to z; of a quaternion it turns the axis.
        position = position[:, [0, 2, 1]] * (1.0, -1.0, 1.0)
        turn = turn[:, [0, 2, 1, 3]] * (1.0, -1.0, 1.0, 1.0)
    names = tuple(one_line(name, 40) for name in unused)
    return Placements(np.array(kinds), position, turn, table[:, 8], table[:, 9], names)


def _records(path: Path) -> Iterator[tuple[int, Mapping[str, Any]]]:
    """Yield records with their lines, or of JSON their numbers."""
    text = read_text(path)
    if path.suffix.lower() != ".json":
        # What is between the lines of comments keeps its numbers.
        told = enumerate(text.splitlines(), start=1)
        kept = [(number, line) for number, line in told if not line.startswith("#")]
        numbers, lines = [number for number, _ in kept], [line for _, line in kept]
        reader = csv.DictReader(lines, skipinitialspace=True)
        for record in reader:
            line = numbers[reader.line_num - 1]
            if record.pop(None, None):  # pyright: ignore[reportArgumentType]
                message = (
                    f"expected {len(reader.fieldnames or ())} cells as in the header, got more"
                )
                raise InputError(f"{message}; correct the row", path=path, line=line)
            yield line, {str(k).strip().lower(): v for k, v in record.items()}
        return
    kind: Any = list[dict[str, Any]] if text.lstrip().startswith("[") else _Instances
    what = "objects with type and place"
    read = decode_json(text.encode(), kind, what, "export it again", path=path, first_line=1)
    records: list[dict[str, Any]] = read.instances if isinstance(read, _Instances) else read
    for number, record in enumerate(records, start=1):
        yield number, {key.lower(): value for key, value in _spread(record).items()}


def _spread(record: Mapping[str, Any]) -> dict[str, Any]:
    """Return a record whose lists have become single numbers."""
    flat = dict(record)
    for key, names in _LISTS.items():
        values: Any = flat.pop(key, None)
        if isinstance(values, Sequence):
            flat |= dict(zip(names, values, strict=False))  # pyright: ignore[reportUnknownArgumentType]
    return flat


def _kind(record: Mapping[str, Any], types: Sequence[str], path: Path, line: int) -> int:
    name = next((record[key] for key in _NAMES if record.get(key)), None)
    if name is None:
        if len(types) == 1:
            return 0
        raise InputError("expected the name of a mesh in type, got none", path=path, line=line)
    plain = Path(str(name)).stem if str(name) not in types else str(name)
    if plain not in types:
        raise InputError(f"type: {unknown_name(plain, list(types))}", path=path, line=line)
    return types.index(plain)


def _numbers(record: Mapping[str, Any], path: Path, line: int) -> list[float]:
    """Return place, quaternion, yaw, scale and importance."""
    missing = [name for name in _PLACE if record.get(name) in (None, "")]
    if missing:
        raise InputError(f"expected {missing[0]} of a place, got none", path=path, line=line)
    usual = dict.fromkeys((*_TURN, *_OTHERS), 0.0) | {"qw": 1.0, "scale": 1.0, "importance": 1.0}
    numbers: list[float] = []
    for name in (*_PLACE, *_TURN, *_OTHERS):
        value = record.get(name)
        try:
            number = float(usual[name] if value in (None, "") else value)
        except (TypeError, ValueError):
            number = math.nan
        if not math.isfinite(number) or abs(number) > 1e9:
            message = f"expected a number within 1e9 for {name}, got {str(value)[:40]!r}"
            raise InputError(f"{message}; correct the record", path=path, line=line)
        numbers.append(number)
    norm = math.hypot(*numbers[3:7])
    if abs(norm - 1.0) > _NORM:
        message = f"expected a unit quaternion, got one of norm {norm:.4g}; check the columns"
        raise InputError(message, path=path, line=line)
    if numbers[8] <= 0.0 or numbers[9] < 0.0:
        message = "expected a scale above 0 and an importance of at least 0, got"
        raise InputError(f"{message} {numbers[8]:g} and {numbers[9]:g}", path=path, line=line)
    return numbers
