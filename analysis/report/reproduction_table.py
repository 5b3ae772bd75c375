"""Claims of papers as a table for a terminal."""

from typing import TYPE_CHECKING

from ..reproduce.experiment import IN_DIRECTION, REPRODUCED
from ..reproduce.reproduction import Reproduction
from .console_tables import plain_table

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console

_STYLES = {REPRODUCED: "green", IN_DIRECTION: "yellow"}


def print_reproduction(result: Reproduction, console: "Console") -> None:
    """Print each claim beside what came out, and how many came out as printed."""
    from rich.text import Text

    table = plain_table()
    for name in ("experiment", "claim", "paper", "here", "tolerance", "verdict"):
        table.add_column(name, overflow="fold")
    entries = tuple(result.entries)
    for entry in entries:
        style = _STYLES.get(entry.verdict, "red")
        cells = (entry.id, entry.claim, entry.paper, entry.ours, entry.tolerance)
        table.add_row(*map(Text, cells), Text(entry.verdict, style=style))
    console.print(table)
    counts = [sum(entry.verdict == word for entry in entries) for word in _STYLES]
    console.print(
        f"{len(entries)} claims: {counts[0]} reproduced, {counts[1]} in direction, "
        f"{len(entries) - sum(counts)} not reproduced"
    )
    for section in result.sections:
        for note in section.notes:
            console.print(f"{section.experiment.id}: {note}", style="dim", markup=False)
