"""The figures of a comparison as files, at the widths of a paper's column and of its page."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..palette import inks
from .along_the_path import draw_along_the_path
from .drawing import drawing_style, require_matplotlib, save_figure
from .sheet import Sheet
from .tradeoff import draw_error_over_work, draw_switches_over_error

if TYPE_CHECKING:
    from ...study.comparison_folder import Compared

WIDTHS_IN = {"column": 3.3, "page": 7.0}
"""Of a column, and of a page of two columns."""

FORMATS = ("pdf", "svg", "png")

_FIGURES: dict[str, Callable[[Sheet], Any]] = {
    "error-over-work": draw_error_over_work,
    "switches-over-error": draw_switches_over_error,
    "work-along-the-path": draw_along_the_path,
}
_FONT_PT = 7.0
# Names are no formulas, whatever they hold; lines are as thin as a journal prints.
_STYLE = {"text__parse_math": False, "axes__linewidth": 0.6}


def write_figures(compared: "Compared", folder: Path) -> list[Path]:
    """Write each figure in each width and format to a folder, which is made; return the files.

    The same comparison gives the same bytes.

    Raises `InputError` without matplotlib, if no policy was scored, or a file cannot be written.
    """
    require_matplotlib("--figures")
    sheets = {
        width: Sheet(compared.comparison, compared.logs, inks(compared.comparison), width_in)
        for width, width_in in WIDTHS_IN.items()
    }
    folder.mkdir(parents=True, exist_ok=True)
    written: list[Path] = []
    for width, sheet in sheets.items():
        for name, draw in _FIGURES.items():
            with drawing_style(_FONT_PT, **_STYLE):
                figure = draw(sheet)
                for kind in FORMATS:
                    written.append(folder / f"{name}-{width}.{kind}")
                    save_figure(figure, written[-1])
    return written
