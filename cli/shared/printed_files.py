"""Files for papers and pull requests that `compare` and `report` both write."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from typer import Option

from ...base.errors import InputError

if TYPE_CHECKING:  # numpy and pyarrow are loaded by the command that needs them
    from ...analysis.study.comparison_folder import Compared

Figures = Annotated[
    Path | None,
    Option(
        metavar="DIR",
        help="Write figures as PDF, SVG and PNG, as wide as a paper's column and page.",
    ),
]
Csv = Annotated[Path | None, Option(metavar="DIR", help="Write every table as CSV.")]
Latex = Annotated[Path | None, Option(metavar="DIR", help="Write every table as LaTeX (booktabs).")]
Markdown = Annotated[
    bool, Option("--markdown", help="Print a summary as Markdown, for a pull request.")
]
Baseline = Annotated[
    Path | None,
    Option(metavar="DIR", help="With --markdown: say what changed since another comparison."),
]


@dataclass(frozen=True, slots=True)
class PrintedFiles:
    """What is to be written of a comparison, and whether its summary is printed.

    Raises `InputError` if options do not go together, or there is nothing to draw with.
    """

    figures: Path | None
    csv: Path | None
    latex: Path | None
    markdown: bool
    baseline: Path | None
    as_json: bool

    def __post_init__(self) -> None:
        if self.markdown and self.as_json:
            raise InputError("--markdown: expected no --json beside it, got both; leave one out")
        if self.baseline is not None and not self.markdown:
            raise InputError("--baseline: expected --markdown, which tells the changes; add it")
        if self.figures is not None:
            from ...analysis.report.printed.drawing import require_matplotlib

            require_matplotlib("--figures")

    def __bool__(self) -> bool:
        return self.markdown or bool(self._folders)

    @property
    def _folders(self) -> dict[str, Path]:
        named = {"figures": self.figures, "csv": self.csv, "latex": self.latex}
        return {name: folder for name, folder in named.items() if folder is not None}

    def check(self, comparison: Path | None) -> None:
        """Raise `InputError` where a folder is that of the comparison, which is replaced whole."""
        for name, folder in self._folders.items():
            if folder.exists() and not folder.is_dir():
                raise InputError("expected a folder to write to, got a file", path=folder)
            if comparison is not None and folder.resolve().is_relative_to(comparison.resolve()):
                raise InputError(
                    f"--{name}: expected a folder outside of the comparison's, which holds nothing "
                    f"else, got {folder}; name another"
                )

    def write(self, compared: "Compared") -> list[Path]:
        """Write the files; return them."""
        written: list[Path] = []
        if self.figures is not None:
            from ...analysis.report.printed.figures import write_figures

            written += write_figures(compared, self.figures)
        if self.csv is not None:
            from ...analysis.report.printed.csv_tables import write_csv_tables

            written += write_csv_tables(compared.comparison, self.csv)
        if self.latex is not None:
            from ...analysis.report.printed.latex_tables import write_latex_tables

            written += write_latex_tables(compared.comparison, self.latex)
        return written

    def read_baseline(self) -> "Compared | None":
        """Return the comparison that changes are told against, if there is one."""
        from ...analysis.study.comparison_folder import read_results

        return None if self.baseline is None else read_results(self.baseline)

    def summary(self, compared: "Compared", baseline: "Compared | None") -> str:
        """Return the summary as Markdown, with what changed since the baseline."""
        from ...analysis.report.printed.markdown import comparison_markdown
        from ...analysis.verdict.changes import find_changes

        changes = None if baseline is None else find_changes(baseline, compared)
        return comparison_markdown(compared.comparison, changes)
