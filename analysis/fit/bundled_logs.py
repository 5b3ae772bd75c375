"""Bundled logs: what papers printed, and what bundled profiles were fitted to."""

from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from ...traces.logs.render_log import TimeName

_FOLDER = Path(__file__).parent / "logs"


@dataclass(frozen=True, slots=True)
class BundledFit:
    """What a bundled profile was fitted to, and with which settings; the others are the defaults.

    Attributes
    ----------
    logs : files of the logs, fitted together
    terms : terms as `terms.parse_terms` reads them
    """

    logs: tuple[Path, ...]
    terms: str
    target: TimeName


_FITS = {
    "llvmpipe": BundledFit(
        (_FOLDER / "llvmpipe.parquet",),
        "draw_calls,triangles,rasterized_triangles,framebuffer_pixels",
        "frame_ms",
    ),
}


def bundled_fit(name: str) -> BundledFit:
    """Return what the bundled profile of that name was fitted to.

    Raises `InputError` if no fitted profile has that name, with the nearest that has.
    """
    if name in _FITS:
        return _FITS[name]
    raise InputError(f"--bundled: {unknown_name(name, _FITS)}")


def list_logs() -> tuple[str, ...]:
    """Return the names of the logs that papers printed, sorted."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.csv")))


def bundled_log(name: str) -> Path | None:
    """Return the file of a log that a paper printed, or None if there is none of that name."""
    return _FOLDER / f"{name}.csv" if name in list_logs() else None
