"""Frame logs as Parquet: one column a field, the header as key-value metadata.

A log that keeps levels has behind these the orientation of the camera and two lists a frame: which
nodes are drawn at another level than in the frame before, and at which, -1 where they are no more.
"""

from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from ..base.errors import InputError, about_file
from ..base.files.parquet_file import ParquetColumns, write_columns
from ..base.files.strict_json import decode_json
from ..base.files.whole_file import whole_file
from ..base.reader_guard import guarded
from .frame_log import COUNTS, DEPTH, TIMES, FrameLog, LogHeader
from .level_history import LevelHistory

_SCHEMA = "lodbench.frame-log/2"
_TURNS = ("turn_x", "turn_y", "turn_z", "turn_w")
_NODES, _LEVELS = "changed_nodes", "changed_levels"
_ADVICE = "give frames/<policy>.parquet of a run of `lodbench compare`"


def write_frame_log(path: str | Path, log: FrameLog) -> None:
    """Write a frame log to Parquet as `whole_file` does, which may raise its errors."""
    texts = {"schema": _SCHEMA, "header": msgspec.json.encode(log.header)}
    with whole_file(Path(path)) as partial:
        columns: dict[str, Any] = {name: log[name] for name in log.columns}
        if log.levels is not None:
            columns |= _level_columns(log.levels, len(log))
        write_columns(partial, columns, texts)


def read_frame_log(path: str | Path) -> FrameLog:
    """Read a frame log that `write_frame_log` wrote.

    Raises `InputError` if the file is missing, is no Parquet, or has another schema.
    """
    with guarded(path, "a frame log", _ADVICE):
        return _read(Path(path))


def _read(source: Path) -> FrameLog:
    if not source.is_file():
        raise InputError(f"expected a frame log, got no file; {_ADVICE}", path=source)
    table = ParquetColumns(source, _ADVICE)
    schema = table.text("schema") or "none"
    depths = [name for name in table.names if name.startswith(DEPTH)]
    known = [*TIMES, *COUNTS, *(f"{DEPTH}{depth}" for depth in range(len(depths)))]
    keeps_levels = _NODES in table.names
    if keeps_levels:
        known += [*_TURNS, _NODES, _LEVELS]
    if schema != _SCHEMA or table.names != known:
        raise InputError(f"expected schema {_SCHEMA}, got {schema}; {_ADVICE}", path=source)
    text = table.text("header").encode()
    header = decode_json(text, LogHeader, "a frame-log header", _ADVICE, path=source)
    times = np.column_stack([table.whole_numbers(name) for name in TIMES])
    counts = np.column_stack([table.numbers(name) for name in COUNTS])
    by_depth = [table.whole_numbers(name) for name in depths]
    deep = np.column_stack(by_depth) if by_depth else np.zeros(0, dtype=np.int64)
    with about_file(source):
        levels = _read_levels(table) if keeps_levels else None
        return FrameLog(header, times, counts, deep, levels)


def _level_columns(levels: LevelHistory, frames: int) -> dict[str, Any]:
    """Return a history as columns; frames behind its last have none."""
    import pyarrow as pa

    arrow_list: Any = pa.ListArray
    kept = np.arange(frames) < len(levels)
    turns = np.zeros((frames, 4))
    turns[kept] = levels.turn_xyzw
    columns: dict[str, Any] = {
        name: pa.array(turns[:, at], mask=~kept) for at, name in enumerate(_TURNS)
    }
    ends = np.concatenate((levels.start, np.full(frames - len(levels), levels.start[-1])))
    for name, values in ((_NODES, levels.node), (_LEVELS, levels.level)):
        columns[name] = arrow_list.from_arrays(
            pa.array(ends.astype(np.int32)), pa.array(values), mask=pa.array(~kept)
        )
    return columns


def _read_levels(table: ParquetColumns) -> LevelHistory:
    start, node = table.lists(_NODES)
    again, level = table.lists(_LEVELS)
    if not np.array_equal(start, again):
        raise InputError(f"expected a level for each changed node, got others; {_ADVICE}")
    frames = len(start) - 1
    turns = np.column_stack([table.numbers(name)[:frames] for name in _TURNS])
    if node.max(initial=0) >= 1 << 31 or np.abs(level).max(initial=0) >= 1 << 15:
        raise InputError(f"expected numbers of nodes and levels, got others; {_ADVICE}")
    return LevelHistory(start, node.astype(np.int32), level.astype(np.int16), turns)
