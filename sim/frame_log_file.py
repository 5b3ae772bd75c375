"""Frame logs as Parquet: one column a field, the header as key-value metadata."""

from pathlib import Path

import msgspec
import numpy as np

from ..base.errors import InputError
from ..base.files.parquet_file import ParquetColumns, write_columns
from ..base.files.strict_json import decode_json
from ..base.files.whole_file import whole_file
from ..base.reader_guard import guarded
from .frame_log import COUNTS, DEPTH, TIMES, FrameLog, LogHeader

_SCHEMA = "lodbench.frame-log/2"
_ADVICE = "give frames/<policy>.parquet of a run of `lodbench compare`"


def write_frame_log(path: str | Path, log: FrameLog) -> None:
    """Write a frame log to Parquet as `whole_file` does, which may raise its errors."""
    texts = {"schema": _SCHEMA, "header": msgspec.json.encode(log.header)}
    with whole_file(Path(path)) as partial:
        write_columns(partial, {name: log[name] for name in log.columns}, texts)


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
    if schema != _SCHEMA or table.names != known:
        raise InputError(f"expected schema {_SCHEMA}, got {schema}; {_ADVICE}", path=source)
    text = table.text("header").encode()
    header = decode_json(text, LogHeader, "a frame-log header", _ADVICE, path=source)
    times = np.column_stack([table.whole_numbers(name) for name in TIMES])
    counts = np.column_stack([table.numbers(name) for name in COUNTS])
    by_depth = [table.whole_numbers(name) for name in depths]
    return FrameLog(header, times, counts, *([np.column_stack(by_depth)] if by_depth else []))
