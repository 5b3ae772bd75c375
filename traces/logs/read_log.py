"""Read a render log from a file of any known format, named or recognised by its content."""

from pathlib import Path

from ...base.errors import InputError, about_users_code, require_kind
from ...base.name_registry import Registry
from ...base.reader_guard import guarded
from .known_tools import refuse_known_tool
from .log_format import Columns, LogFormat, LogHead
from .render_log import RenderLog

LOG_FORMATS: Registry[LogFormat] = Registry(
    "log format",
    LogFormat,
    f"{__package__}.formats",
    {
        "parquet": "log_parquet:FORMAT",
        "mangohud": "mangohud:FORMAT",
        "capframex": "capframex:FORMAT",
        "presentmon": "presentmon:FORMAT",
        "unreal": "unreal_csv:FORMAT",
        "unity": "unity_csv:FORMAT",
        "afterburner": "afterburner:FORMAT",
        "fraps": "fraps:FORMAT",
        "android": "android_framestats:FORMAT",
        "json": "log_json:FORMAT",
        "csv": "log_csv:FORMAT",  # takes what is left, and says what it misses
    },
)
"""All formats by name, in the order in which a file is shown to them."""

_HEAD_BYTES = 1 << 16


def register_format(name: str, known: LogFormat) -> None:
    """Give a format of your own a name, and show files to it before the others.

    Raises `InputError` if the name is taken, or `known` is no `LogFormat`.
    """
    LOG_FORMATS.register(name, known)


def read_render_log(
    path: Path, mapping: Columns = None, log_format: str | None = None
) -> RenderLog:
    """Read a log.

    Raises `InputError` if the format is not known, the file breaks it, it has no column to map, or
    a format of a user's own fails.

    Parameters
    ----------
    log_format
        A name in `LOG_FORMATS`, or ``file.py:NAME`` or ``package.module:NAME`` of a `LogFormat`;
        None recognises the format by the content.
    """
    with guarded(path, "a render log"):
        name = log_format_of(path) if log_format is None else log_format
        chosen = LOG_FORMATS.find(name)
        if mapping and not chosen.predictors:
            message = f"expected no mapping, since a {name} log holds nothing but times"
            raise InputError(f"{message}; remove it, or name the format csv", path=path)
        with about_users_code(chosen.read, name, path):
            log = chosen.read(path, mapping)
        return require_kind(log, RenderLog, name, path)


def log_format_of(path: Path) -> str:
    """Return the name in `LOG_FORMATS` of a file's format, by its content.

    Raises `InputError` if the file cannot be read, or a format of a user's own fails.
    """
    try:
        with path.open("rb") as file:
            head = LogHead(file.read(_HEAD_BYTES))
    except (OSError, ValueError) as error:  # ValueError: a zero byte in the file name
        reason = getattr(error, "strerror", None) or error
        message = f"expected a file that can be read, got {reason}; check the path"
        raise InputError(message, path=path) from error
    refuse_known_tool(head, path)
    name = next(name for name in LOG_FORMATS if _recognises(name, head, path))
    if (
        name in {"capframex", "json", "csv"}
        and head.text.startswith(("[", "{"))
        and '"ph"' in head.text
    ):
        message = "expected a render log, got Chrome trace events, which have no table of frames"
        raise InputError(f"{message}; export the counters as CSV", path=path)
    return name


def _recognises(name: str, head: LogHead, path: Path) -> bool:
    known = LOG_FORMATS.find(name)
    with about_users_code(known.recognises, name, path):
        return bool(known.recognises(head))
