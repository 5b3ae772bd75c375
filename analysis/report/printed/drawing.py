"""What all pictures of matplotlib have in common: vector text, no dates, the same bytes again."""

import warnings
from collections.abc import Generator
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from ....base.errors import InputError
from ....base.files.whole_file import whole_file

_SETTINGS: Any = {
    "svg.hashsalt": "lodbench",
    "svg.fonttype": "none",  # text stays text
    "pdf.fonttype": 42,  # TrueType, which publishers ask for
}
_METADATA: dict[str, dict[str, str | None]] = {
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
    "png": {"Software": None},
}
_PNG_DPI = 300


def require_matplotlib(what: str) -> None:
    """Raise `InputError` if there is nothing to draw with; `what` is named in the message."""
    if find_spec("matplotlib") is None:
        raise InputError(
            f"{what}: expected matplotlib, got none; pip install 'lodbench[fit-plots]'"
        )


@contextmanager
def drawing_style(font_size: float, **more: Any) -> Generator[None]:
    """Draw and save figures in a font size, in points, and with more settings of matplotlib."""
    import matplotlib as mpl

    settings = _SETTINGS | {"font.size": font_size} | {k.replace("__", "."): more[k] for k in more}
    with mpl.rc_context(settings):
        yield


def new_figure(width_in: float, height_in: float) -> Any:
    """Return an empty figure, which knows no window."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width_in, height_in), layout="constrained")


def clear_spines(axes: Any) -> None:
    """Leave of the frame what carries numbers, and draw a faint grid."""
    axes.grid(visible=True, color="#dddddd", lw=0.6)
    axes.spines[["top", "right"]].set_visible(False)


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure in the format of the file's ending: svg, pdf or png.

    Raises `InputError` if the file cannot be written.
    """
    kind = path.suffix.removeprefix(".")
    with warnings.catch_warnings(), whole_file(path) as partial:
        # A name may hold letters that the font lacks; a box stands for them in PDF and PNG.
        warnings.filterwarnings("ignore", message="Glyph .* missing from")
        figure.savefig(partial, format=kind, metadata=_METADATA[kind], dpi=_PNG_DPI)
