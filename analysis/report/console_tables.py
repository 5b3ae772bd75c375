"""What tables for a terminal have in common."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.table import Table


def titled_table(title: str, columns: Sequence[str], left: Sequence[str] = ()) -> "Table":
    """Return an empty table of numbers; the first column and those named are of text."""
    from rich.table import Table
    from rich.text import Text

    table = Table(title=Text(title))
    for column in columns:
        if column in (columns[0], *left):
            table.add_column(column, overflow="fold")
        else:
            table.add_column(column, justify="right", no_wrap=True)
    return table


def plain_table() -> "Table":
    """Return an empty table without frame."""
    from rich import box
    from rich.table import Table

    return Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False, header_style="dim")
