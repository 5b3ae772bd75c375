"""Render logs as CSV with a header: lodbench's own, and any other by aliases or a mapping.

Lodbench's own has the columns ``draw_calls, vertices, triangles, shaded_samples`` … of
`render_log.COUNTS` and ``cpu_ms, gpu_ms, frame_ms, time_s``, and a first line
``# renderer: NAME; VERSION; WIDTHxHEIGHT; mode MODE; seed SEED``.
"""

import re
from collections.abc import Sequence
from pathlib import Path

from ..log_build import LogText, build_log
from ..log_columns import find_columns
from ..log_format import Columns, LogFormat
from ..log_table import LogTable, read_log_bytes, split_table
from ..render_log import RenderLog


def read_csv_log(path: Path, mapping: Columns = None) -> RenderLog:
    """Return the log in a CSV; mapped columns go before those known by the words of their names.

    Raises `InputError` if no column holds a time, its unit is in doubt, or there are no numbers.
    """
    return log_of_table(split_table(read_log_bytes(path), path), mapping, "csv")


def log_of_table(
    table: LogTable,
    mapping: Columns,
    log_format: str,
    *,
    unit: str = "",
    twins: bool = False,
    header: tuple[tuple[str, str], ...] = (),
    notes: tuple[str, ...] = (),
) -> RenderLog:
    """Return the log in a table whose columns are found by name; raises as `read_csv_log`.

    Parameters
    ----------
    unit, twins
        As `build_log` and `find_columns`.
    header
        What is known of the log, beside the comments of the table.
    """
    line = table.first_line - 1
    found = find_columns(table.header, mapping, path=table.path, line=line, twins=twins)
    values, odd = table.measure([column.index for column in found.columns])
    names = {index: name for index, name in found.unused if name}
    unused = tuple(names[index] for index in table.numeric(list(names)))
    pairs = (*header, *header_pairs(table.comments))
    text = LogText(pairs, notes, odd, unused)
    return build_log(values, found, text, path=table.path, log_format=log_format, unit=unit)


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
