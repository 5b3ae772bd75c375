"""Frame logs as Parquet: one column a field, the header as key-value metadata."""

from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from ..base.errors import InputError
from ..base.strict_json import decode_json
from ..base.whole_file import whole_file
from .frame_log import COUNTS, TIMES, FrameLog, LogHeader

_SCHEMA = b"lodbench.frame-log/1"
_ADVICE = "give frames/<policy>.parquet of a run of `lodbench compare`"


def write_frame_log(path: str | Path, log: FrameLog) -> None:
    """Write a frame log to Parquet as `whole_file` does, which may raise its errors."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = {name: log[name] for name in (*TIMES, *COUNTS)}
    metadata = {b"schema": _SCHEMA, b"header": msgspec.json.encode(log.header)}
    table = pa.table(columns, metadata=metadata)
    with whole_file(Path(path)) as partial:
        pq.write_table(table, partial, compression="zstd")


def read_frame_log(path: str | Path) -> FrameLog:
    """Read a frame log that `write_frame_log` wrote.

    Raises `InputError` if the file is missing, is no Parquet, or has another schema.
    """
    table = _read_table(Path(path))
    metadata: dict[bytes, bytes] = table.schema.metadata or {}
    if metadata.get(b"schema") != _SCHEMA or table.column_names != [*TIMES, *COUNTS]:
        got = metadata.get(b"schema", b"none").decode(errors="replace")
        raise InputError(f"expected schema {_SCHEMA.decode()}, got {got}; {_ADVICE}", path=path)
    header = decode_json(
        metadata.get(b"header", b""), LogHeader, "a frame-log header", _ADVICE, path=Path(path)
    )
    rows: int = table.num_rows
    times = np.empty((rows, len(TIMES)), dtype=np.int64)
    for i, name in enumerate(TIMES):
        times[:, i] = table.column(name).to_numpy()
    counts = np.empty((rows, len(COUNTS)))
    for i, name in enumerate(COUNTS):
        counts[:, i] = table.column(name).to_numpy()
    return FrameLog(header, times, counts)


def _read_table(source: Path) -> Any:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        return pq.read_table(source)
    except FileNotFoundError:
        raise InputError(f"expected a frame log, got no file; {_ADVICE}", path=source) from None
    except (OSError, pa.ArrowInvalid) as error:
        raise InputError(
            f"expected a Parquet frame log, got {error}; {_ADVICE}", path=source
        ) from error
