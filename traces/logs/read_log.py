"""Read a render log from a file of any known format, named or recognised by its content."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from .formats.capframex import read_capframex
from .formats.log_csv import read_csv_log
from .formats.log_parquet import MAGIC, read_parquet_log
from .formats.mangohud import is_mangohud, read_mangohud
from .formats.presentmon import is_presentmon, read_presentmon
from .formats.unity_csv import is_unity, read_unity_csv
from .formats.unreal_csv import is_unreal, read_unreal_csv
from .log_timings import log_from_timings
from .render_log import RenderLog

_Mapping = Mapping[str, str] | None
_HEAD_BYTES = 1 << 16


@dataclass(frozen=True, slots=True)
class LogFormat:
    """One file format of render logs.

    Attributes
    ----------
    what : one line for tables
    read : takes a path and a mapping
    predictors : whether it can hold what was drawn, and so takes a mapping
    """

    what: str
    read: Callable[[Path, _Mapping], RenderLog]
    predictors: bool = True


LOG_FORMATS: dict[str, LogFormat] = {
    "csv": LogFormat("any CSV with a header, lodbench's own among them", read_csv_log),
    "parquet": LogFormat("the columns of the CSV as Parquet", read_parquet_log),
    "unreal": LogFormat("Unreal's CSV profiler", read_unreal_csv),
    "unity": LogFormat("Unity's profiler counters as CSV", read_unity_csv),
    "mangohud": LogFormat(
        "MangoHud; times only", lambda path, _: read_mangohud(path), predictors=False
    ),
    "presentmon": LogFormat(
        "PresentMon and OCAT; times only",
        lambda path, _: log_from_timings(read_presentmon(path), path.stem),
        predictors=False,
    ),
    "capframex": LogFormat(
        "CapFrameX, JSON or CSV; times only",
        lambda path, _: log_from_timings(read_capframex(path), path.stem),
        predictors=False,
    ),
}


def read_render_log(
    path: Path, mapping: _Mapping = None, log_format: str | None = None
) -> RenderLog:
    """Read a log.

    Raises `InputError` if the format is not known, the file breaks it, or it has no column to map.

    Parameters
    ----------
    mapping
        Columns by the names of `renderlog`: ``{"gpu_ms": "GPUTime", "triangles": "Prims"}``.
    log_format
        A key of `LOG_FORMATS`; None recognises the format by the content.
    """
    name = log_format_of(path) if log_format is None else log_format
    chosen = LOG_FORMATS.get(name)
    if chosen is None:
        raise InputError(f"log format: {unknown_name(name, LOG_FORMATS)}")
    if mapping and not chosen.predictors:
        message = f"expected no mapping, since a {name} log holds nothing but times"
        raise InputError(f"{message}; remove it, or name the format csv", path=path)
    return chosen.read(path, mapping)


def log_format_of(path: Path) -> str:
    """Return the format of a file by its content, a key of `LOG_FORMATS`.

    What nothing else recognises is taken for CSV, which then says what it misses.

    Raises `InputError` if the file cannot be read.
    """
    try:
        with path.open("rb") as file:
            head = file.read(_HEAD_BYTES)
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the file name
        reason = getattr(error, "strerror", None) or error
        message = f"expected a file that can be read, got {reason}; check the path"
        raise InputError(message, path=path) from error
    if head.startswith(MAGIC):
        return "parquet"
    encoding = "utf-16" if head[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig"
    lines = [line.strip() for line in head.decode(encoding, "ignore").splitlines()]
    if lines and lines[0].startswith(("[", "{")) and b'"ph"' in head:
        message = "expected a render log, got Chrome trace events, which have no table of frames"
        raise InputError(f"{message}; export the counters as CSV", path=path)
    return _of_lines([line for line in lines if line])


def _of_lines(lines: list[str]) -> str:
    if lines and lines[0].startswith("{"):
        return "capframex"
    if is_mangohud(lines):
        return "mangohud"
    row = next((line for line in lines if not line.startswith(("#", "//"))), "")
    delimiter = max(",;\t", key=row.count)
    header = tuple(name.strip().strip('"') for name in row.split(delimiter))
    if is_presentmon(header):
        return "capframex" if lines[0].startswith("//") else "presentmon"
    if is_unreal(header):
        return "unreal"
    return "unity" if is_unity(header) else "csv"
