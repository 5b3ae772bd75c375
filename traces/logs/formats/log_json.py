"""Render logs as JSON: an array of records, a record a line, or an array for each column.

Records may stand below a key (``{"frames": […]}``) and hold records (``{"gpu": {"ms": 7}}``, a
column ``gpu.ms``).  Columns are found by the words of their names, as in a CSV.
"""

from pathlib import Path
from typing import Any, cast

import msgspec
import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ....base.files.text_file import read_text
from ..log_build import LogText, build_log
from ..log_cells import OddCells, number_of
from ..log_columns import find_columns
from ..log_format import Columns, LogFormat, LogHead
from ..log_table import MOST_CELLS
from ..render_log import RenderLog

Record = dict[str, Any]

_LARGEST_BYTES = 1 << 26  # 64 MiB of JSON are some 1 GB of objects
_ADVICE = "give an array of records, one a frame"
_DEEPEST = 3  # records within records


def read_json_log(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log in a JSON file; mapped columns go before those known by their names.

    Raises `InputError` if it is no such JSON, or as `read_csv_log`.
    """
    records, broken = _records(path)
    columns: dict[str, list[object]] = {}
    for row, record in enumerate(records):
        for name, value in _flat(record):
            column = columns.setdefault(name, [])
            column += [None] * (row - len(column))
            column.append(value)
    found = find_columns(list(columns), mapping, path=path, line=None)
    if len(records) * len(found.columns) > MOST_CELLS:
        message = f"expected at most {MOST_CELLS:,} numbers, got {len(records):,} records"
        raise InputError(f"{message}; split the log", path=path)
    odd = OddCells()
    rows = len(records)
    values = np.column_stack(
        [_numbers(columns[column.source], column.source, rows, odd) for column in found.columns]
    )
    unused = tuple(name for _, name in found.unused if _is_numeric(columns[name]))
    notes = (*odd.notes(), *([f"{broken} lines are no records: left aside"] if broken else []))
    text = LogText(odd=notes, unused=unused)
    return build_log(values, found, text, path=path, log_format="json")


def _records(path: Path) -> tuple[list[Record], int]:
    """Return one record a frame, and how many lines of a file of lines are none."""
    text = read_text(path, largest_bytes=_LARGEST_BYTES, advice="split the log").strip()
    try:
        whole: Any = msgspec.json.decode(text)
    except (msgspec.DecodeError, RecursionError) as error:
        return _lines(text, error, path)
    records = _found_records(whole, 0)
    if records is None:
        raise InputError(f"expected records of frames, got other JSON; {_ADVICE}", path=path)
    return records, 0


def _lines(text: str, error: Exception, path: Path) -> tuple[list[Record], int]:
    records: list[Record] = []
    broken = 0
    for line in text.splitlines():
        try:
            value: Any = msgspec.json.decode(line.strip().rstrip(",")) if line.strip() else None
        except (msgspec.DecodeError, RecursionError):
            broken += 1
            continue
        if isinstance(value, dict):
            records.append(cast("Record", value))
        elif value is not None:
            broken += 1
    if not records or broken > len(records):
        reason = str(error).partition(" (byte")[0]
        raise InputError(f"expected JSON, got {reason}; {_ADVICE}", path=path, line=1) from error
    return records, broken


def _found_records(value: Any, depth: int) -> list[Record] | None:
    """Return the records of an array, of columns, or of the first of either below a key."""
    if isinstance(value, list):
        rows = cast("list[Any]", value)
        records = [cast("Record", row) for row in rows if isinstance(row, dict)]
        return records if records and len(records) >= len(rows) // 2 else None
    if not isinstance(value, dict) or depth > _DEEPEST:
        return None
    table = cast("dict[str, Any]", value)
    columns = {
        name: cast("list[Any]", column)
        for name, column in table.items()
        if isinstance(column, list)
        and not any(isinstance(cell, (dict, list)) for cell in cast("list[Any]", column))
    }
    lengths = [len(column) for column in columns.values()]
    if lengths and max(lengths) > 1:
        longest = max(lengths)
        whole = {name: column for name, column in columns.items() if len(column) == longest}
        return [dict(zip(whole, row, strict=True)) for row in zip(*whole.values(), strict=True)]
    below = (_found_records(inner, depth + 1) for inner in table.values())
    return next((records for records in below if records), None)


def _flat(record: Record, before: str = "", depth: int = 0) -> list[tuple[str, object]]:
    pairs: list[tuple[str, object]] = []
    for name, value in record.items():
        if isinstance(value, dict) and depth < _DEEPEST:
            pairs += _flat(cast("Record", value), f"{before}{name}.", depth + 1)
        elif not isinstance(value, (dict, list)):
            pairs.append((before + name, value))
    return pairs


def _number(value: object) -> float | None:
    if value is None:
        return np.nan
    if isinstance(value, str):
        return number_of(value, "thousands")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        return float(value) if np.isfinite(float(value)) else None
    except OverflowError:
        return None


def _numbers(column: list[object], name: str, rows: int, odd: OddCells) -> FloatArray:
    values = np.full(rows, np.nan)
    for row, value in enumerate(column):
        number = _number(value)
        if number is None:
            odd.add(name, str(value)[:40])
        else:
            values[row] = number
    return values


def _is_numeric(column: list[object]) -> bool:
    told = [value for value in column[:200] if value is not None]
    return sum(_number(value) is not None for value in told) > 0.8 * len(told)


def _recognises(head: LogHead) -> bool:
    return head.text[:1] in ("{", "[") and '"' in head.text[:4096]


FORMAT = LogFormat("JSON: records, lines of records, or columns", _recognises, read_json_log)
