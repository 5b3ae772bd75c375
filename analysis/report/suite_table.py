"""The leaderboard of a suite as a table for a terminal, with what became of each cell."""

from typing import TYPE_CHECKING

from ..study.suite.suite_record import CellResult, Leader, Standing, SuiteResult
from .console_tables import plain_table
from .values import ABSENT

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console
    from rich.table import Table


def print_suite(result: SuiteResult, console: "Console") -> None:
    """Print the leaderboard, what its columns are, and why policies have no rank."""
    console.print(
        f"suite {result.suite}, version {result.suite_version} ({result.suite_hash[:8]}): "
        f"{len(result.cells)} comparisons",
        style="bold",
    )
    console.print("", _leaderboard(result))
    console.print(
        "kept: budgets kept with probability .9 or more on such paths; mean rank over these. A "
        "column a comparison: the rank there, or p, the probability of keeping it, of who may not.",
        style="dim",
    )
    for number, cell in enumerate(result.cells, start=1):
        console.print(f"{number}: {cell.name}", style="dim", markup=False)
        for warning in cell.warnings:
            console.print(f"   warning: {warning}", style="yellow", markup=False)
    for label, reason in _reasons(result):
        console.print(f"{label} failed: {reason}", style="bold red", markup=False, soft_wrap=True)


def _leaderboard(result: SuiteResult) -> "Table":
    from rich.text import Text

    table = plain_table()
    table.add_column("place", justify="right", no_wrap=True)
    table.add_column("policy", overflow="fold")
    for name in ("kept", "mean rank", *map(str, range(1, 1 + len(result.cells)))):
        table.add_column(name, justify="right", no_wrap=True)
    for leader in result.leaderboard:
        cells = (standing_text(standing_of(cell, leader.label)) for cell in result.cells)
        kept = f"{leader.kept}/{len(result.cells)}"
        style = "bold green" if leader.submitted else ""
        row = (str(leader.place), Text(leader.label), kept, mean_text(leader), *cells)
        table.add_row(*row, style=style)
    return table


def mean_text(leader: Leader) -> str:
    """Return a mean rank as tables show it."""
    return ABSENT if leader.mean_rank is None else f"{leader.mean_rank:.1f}"


def standing_of(cell: CellResult, label: str) -> Standing:
    """Return what became of a policy in a comparison."""
    return next(one for one in cell.standings if one.label == label)


def standing_text(standing: Standing) -> str:
    """Return that in a word: its rank, the probability that it keeps the budget, or its fate."""
    if standing.status != "ok":
        return "failed" if standing.status == "failed" else "n/a"
    if standing.rank is not None:
        return str(standing.rank)
    return ABSENT if standing.keeps is None else f"p {standing.keeps:.2f}"


def _reasons(result: SuiteResult) -> list[tuple[str, str]]:
    """Return the first reason of each policy that failed."""
    found: dict[str, str] = {}
    for cell in result.cells:
        for one in cell.standings:
            if one.status == "failed":
                found.setdefault(one.label, f"{cell.name}: {one.reason}")
    return sorted(found.items())
