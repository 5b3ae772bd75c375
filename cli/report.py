"""`lodbench report`: write the report of a comparison again."""

from pathlib import Path
from typing import Annotated

from typer import Argument

from .shared.options import AsJson
from .shared.terminal import print_result

Folder = Annotated[Path, Argument(metavar="DIR", help="A folder that `compare --out` wrote.")]


def report(run: Folder, *, as_json: AsJson = False) -> None:
    """Write DIR/report.html again from comparison.json and the frame logs beside it."""
    from ..analysis.study.comparison_folder import rewrite_report

    target = rewrite_report(run)
    record = {"schema": "lodbench.report/1", "report": str(target)}
    print_result(record, f"report: {target}", as_json=as_json)
