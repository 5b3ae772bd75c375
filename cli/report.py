"""`lodbench report`: write the report of a comparison again, or its figures and tables."""

from pathlib import Path
from typing import Annotated

from typer import Argument

from .shared import printed_files
from .shared.options import AsJson
from .shared.terminal import print_result

Folder = Annotated[Path, Argument(metavar="DIR", help="A folder that `compare --out` wrote.")]


def report(
    run: Folder,
    *,
    figures: printed_files.Figures = None,
    csv: printed_files.Csv = None,
    latex: printed_files.Latex = None,
    markdown: printed_files.Markdown = False,
    baseline: printed_files.Baseline = None,
    as_json: AsJson = False,
) -> None:
    """Write DIR/report.html again, or figures, tables and a summary of the comparison."""
    from ..analysis.study.comparison_folder import read_results, rewrite_report

    printed = printed_files.PrintedFiles(figures, csv, latex, markdown, baseline, as_json)
    printed.check(run)
    if not printed:
        target = rewrite_report(run)
        record = {"schema": "lodbench.report/1", "report": str(target)}
        print_result(record, f"report: {target}", as_json=as_json)
        return
    before, compared = printed.read_baseline(), read_results(run)
    written = [str(path) for path in printed.write(compared)]
    if markdown:
        print(printed.summary(compared, before), end="")
    else:
        record = {"schema": "lodbench.report/1", "written": written}
        print_result(record, "\n".join(written), as_json=as_json)
