"""A search for parameters as tables for a terminal: the answer first, the line to paste last."""

from typing import TYPE_CHECKING

from ..study.search.tuning_record import Side, Trial, Tuning
from .console_tables import plain_table
from .values import ABSENT, format_value

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console
    from rich.table import Table

_SHOWN = 8
"""Trials that are printed; the record has all."""


def print_tuning(tuning: Tuning, console: "Console") -> None:
    """Print whether something better was found, by how much, and what else was tried."""
    axes = ", ".join(axis.name for axis in tuning.over)
    console.print(
        f"{tuning.policy} in {tuning.scene} on {tuning.hardware}, {tuning.budget_ms:.4g} ms: "
        f"{len(tuning.trials)} trials over {axes}",
        style="bold",
        markup=False,
    )
    console.print()
    console.print(tuning.answer, markup=False)
    for warning in tuning.warnings:
        console.print(f"warning: {warning}", style="yellow", markup=False)
    for side in filter(None, (tuning.shipped, tuning.found)):
        console.print(_keeps_text(side), markup=False)
    if tuning.gain:
        console.print("", _gain_table(tuning))
        console.print(
            f"On {len(tuning.judged)} paths that the search did not see, both brought to the "
            f"budget there; {tuning.sampling.level:.0%} intervals over such paths, paired.",
            style="dim",
        )
    console.print("", _trial_table(tuning))
    console.print("On training paths, by which trials were chosen: flattering.", style="dim")
    console.print(f"--policy {tuning.policy_line}", markup=False, soft_wrap=True)


def _keeps_text(side: Side) -> str:
    keeps = side.keeps_budget
    sure = ABSENT if keeps.probability is None else f"{keeps.probability:.2f}"
    return (
        f"{side.label} keeps the budget on such paths with probability {sure} "
        f"(kept {keeps.kept} of {keeps.paths})."
    )


def _gain_table(tuning: Tuning) -> "Table":
    table = plain_table()
    for name in ("metric", "unit", "shipped", "found", "difference", "interval"):
        table.add_column(name, justify="left" if name in ("metric", "unit") else "right")
    for gain in tuning.gain:
        low, high = gain.interval
        numbers = map(format_value, (gain.shipped, gain.found, gain.difference))
        span = f"{format_value(low)} to {format_value(high)}"
        table.add_row(gain.metric, gain.unit, *numbers, span)
    return table


def _trial_table(tuning: Tuning) -> "Table":
    from rich.text import Text

    table = plain_table()
    table.add_column("trial", overflow="fold")
    for name in ("paths", "keeps", "error px", "pops/s", "work ms"):
        table.add_column(name, justify="right", no_wrap=True)
    order = sorted(tuning.trials, key=_late_first)
    for trial in order[:_SHOWN]:
        scores = (trial.keeps, trial.visible_error_px, trial.visible_pops_per_s, trial.work_ms_mean)
        numbers = map(format_value, scores)
        table.add_row(Text(trial.reason or trial.label), str(trial.paths), *numbers)
    return table


def _late_first(trial: Trial) -> tuple[int, bool, float]:
    """Sort by how far a trial came, then by whether it likely keeps, then by its picture."""
    error = trial.visible_error_px
    return (-trial.paths, (trial.keeps or 0.0) < 0.5, float("inf") if error is None else error)
