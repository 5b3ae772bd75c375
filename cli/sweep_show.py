"""`lodbench sweep show`: ask questions to the results of a study."""

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

from typer import Argument, Option

from ..base.errors import InputError
from .shared import options
from .shared.terminal import table_console

Folder = Annotated[Path, Argument(metavar="DIR", help="A folder that `lodbench sweep` wrote.")]
Where = Annotated[
    str | None,
    Option(
        metavar="SQL", help="Which runs, such as \"budget_ms < 20 and policy = 'zach'\"; else all."
    ),
]
Pivot = Annotated[
    str | None,
    Option(metavar="AXIS,…", help="Means over all other axes; the last of several goes across."),
]
Metric = Annotated[
    list[str] | None,
    Option(help="A metric (`list metrics`); may be repeated.  Else a few of them."),
]
Csv = Annotated[bool, Option("--csv", help="Print CSV with every digit.")]
Latex = Annotated[bool, Option("--latex", help="Print a LaTeX table for the package booktabs.")]
BySensitivity = Annotated[
    bool,
    Option(
        "--sensitivity", help="How much of each metric's variance each axis explains by itself."
    ),
]
Html = Annotated[
    Path | None,
    Option(
        metavar="FILE.html",
        help="Write a page, too: each metric over each axis by policy, and what depends on what.",
    ),
]

_LISTED = 40
"""Runs that are listed in a terminal."""


def show(
    folder: Folder,
    *,
    where: Where = None,
    pivot: Pivot = None,
    metric: Metric = None,
    sensitivity: BySensitivity = False,
    html: Html = None,
    as_csv: Csv = False,
    as_latex: Latex = False,
    as_json: options.AsJson = False,
) -> None:
    """List the runs of a study, or their means, or what they depend on."""
    from dataclasses import replace

    from rich.text import Text

    from ..analysis.study.sweep.answer import find_answer
    from ..analysis.study.sweep.plain_table import console_table, csv_text, fitting, latex_text
    from ..base.files.writable import require_file_writable

    if as_csv + as_latex + as_json > 1:
        raise InputError("--csv, --latex, --json: expected one of them, got more; choose one")
    if html is not None:
        require_file_writable(html)
    axes = [axis.strip() for axis in pivot.split(",")] if pivot is not None else None
    answer = find_answer(folder, where=where, pivot=axes, metrics=metric, sensitivity=sensitivity)
    if html is not None:
        _write_page(html, folder, where, metric)
    if as_json:
        print(json.dumps(answer.record(), allow_nan=False))
    elif as_csv:
        print(csv_text(answer.exact), end="")
        _tell(answer.notes)
    elif as_latex:
        print("\n".join(map(latex_text, answer.tables)), end="")
        _tell(answer.notes)
    else:
        console = table_console(160)
        for table in answer.tables:
            brief = replace(table, rows=table.rows[:_LISTED]) if answer.kind == "list" else table
            for part in fitting(brief, console.width):
                console.print(console_table(part))
        left = len(answer.exact.rows) - _LISTED
        if answer.kind == "list" and left > 0:
            console.print(f"and {left:,} more runs, which --csv lists too")
        for note in answer.notes:
            console.print(Text(note), soft_wrap=True)


def _write_page(html: Path, folder: Path, where: str | None, metrics: Sequence[str] | None) -> None:
    """Write the page of the runs for which a condition holds."""
    from ..analysis.report.pages.sweep_page import render_sweep
    from ..analysis.study.comparison import SHOWN
    from ..analysis.study.sweep.query import Query
    from ..analysis.study.sweep.study_results import read_study_results
    from ..base.files.whole_file import write_whole

    query = Query(read_study_results(folder), where)
    write_whole(html, render_sweep(query, metrics or SHOWN, where))


def _tell(notes: Sequence[str]) -> None:
    """Print notes where they are not in the way of what is pasted."""
    for note in notes:
        print(note, file=sys.stderr)
