"""Read a render log from a file of any known format, named or recognised by its content."""

from collections.abc import Mapping
from pathlib import Path

from .log_csv import read_csv_log
from .logtable import read_log_bytes
from .renderlog import RenderLog

__all__ = ["read_render_log"]


def read_render_log(path: Path, mapping: Mapping[str, str] | None = None) -> RenderLog:
    """Read a render log; raises InputError."""
    return read_csv_log(read_log_bytes(path), path, mapping)
