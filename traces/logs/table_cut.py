"""A table cut to what is needed of it, where rows are longer or shorter than the header."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from .log_table import LogTable, is_shifted, require_columns


def cut_to(table: LogTable, columns: Sequence[int]) -> tuple[LogTable, tuple[str, ...]]:
    """Return a table of the columns up to the last that is needed, all rows of one length.

    Rows that do not reach it become blank lines, so that lines keep their numbers, and are counted;
    so do rows that are shorter than most, in which a column may be missing anywhere.
    """
    needed, width = max(columns, default=-1) + 1, require_columns(table)
    usual = Counter(len(row) for row in table.sample()).most_common(1)
    least = max(needed, min(usual[0][0] if usual else 0, width))
    lines = [""] * (table.body.count(b"\n") + 1)
    short = rows = 0
    for line, fields in table.rows():
        rows += 1
        if len(fields) < least or is_shifted(fields, width):
            short += 1
            continue
        quoted = (
            '"' + field.replace('"', '""') + '"'
            if table.delimiter in field or '"' in field
            else field
            for field in fields[:needed]
        )
        lines[line - table.first_line] = table.delimiter.join(quoted)
    notes: tuple[str, ...] = ()
    if short:
        notes = (f"{short:,} of {rows:,} rows lack columns, or have too many: left aside",)
    body = "\n".join(lines).encode("utf-8")
    return replace(table, header=table.header[:needed], body=body), notes
