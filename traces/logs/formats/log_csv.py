"""Render logs as CSV with a header: lodbench's own, and any other by aliases or a mapping.

Lodbench's own has the columns ``draw_calls, vertices, triangles, shaded_samples`` … of
`render_log.COUNTS` and ``cpu_ms, gpu_ms, frame_ms, time_s``, and a first line
``# renderer: NAME; VERSION; WIDTHxHEIGHT; mode MODE; seed SEED``.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from ..log_build import build_log
from ..log_columns import find_columns
from ..log_format import Columns, LogFormat
from ..log_table import read_log_bytes, split_table
from ..render_log import RenderLog


def read_csv_log(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log in a CSV; mapped columns go before those known by an alias.

    Raises `InputError` if no column holds a time, or a row is broken.
    """
    table = split_table(read_log_bytes(path), path)
    columns, notes = find_columns(table.header, mapping, path=path, line=table.first_line - 1)
    return build_log(
        table.numbers([column.index for column in columns]),
        columns,
        name=path.stem,
        log_format="csv",
        header=header_pairs(table.comments),
        notes=notes,
    )


def header_pairs(comments: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return pairs of key and value of comment lines such as ``renderer: R; 640x360; seed 3``."""
    pairs: list[tuple[str, str]] = []
    for part in (part.strip() for comment in comments for part in comment.split(";")):
        named = re.match(r"([^:=]{1,60}?)\s*[:=]\s*(.+)", part) or re.match(
            r"([a-z]+) (\S+)$", part
        )
        if named:
            pairs.append((named[1], named[2]))
        elif re.fullmatch(r"\d+x\d+", part):
            pairs.append(("resolution", part))
        elif part:
            pairs.append(("version", part))
    return tuple(pairs)


FORMAT = LogFormat("any CSV with a header, lodbench's own among them", lambda _: True, read_csv_log)
