"""Measurements that papers printed, bundled as small logs."""

from pathlib import Path

__all__ = ["bundled_log", "list_logs"]

_FOLDER = Path(__file__).parent / "logs"


def list_logs() -> tuple[str, ...]:
    """Return the names of the bundled logs, sorted."""
    return tuple(sorted(path.stem for path in _FOLDER.glob("*.csv")))


def bundled_log(name: str) -> Path | None:
    """Return the file of a bundled log, or None if there is none of that name."""
    return _FOLDER / f"{name}.csv" if name in list_logs() else None
