"""A log format that lodbench does not know, brought by its user."""

from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.read_log import (
    LOG_FORMATS,
    log_format_of,
    read_render_log,
    register_format,
)

OWN = """
import numpy as np
from lodbench.traces.logs.log_format import LogFormat
from lodbench.traces.logs.render_log import RenderLog


def read(path, mapping):
    times = np.array(path.read_text().split()[1:], dtype=float)
    return RenderLog(path.stem, "ticks", (), np.empty((len(times), 0)), frame_ms=times / 1000)


TICKS = LogFormat(
    "microseconds", lambda head: head.lines[:1] == ["ticks"], read, predictors=False
)
"""


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return what names a format in a user's file, beside a log in that format."""
    monkeypatch.setattr(LOG_FORMATS, "_users", {})
    (tmp_path / "own.py").write_text(OWN)
    (tmp_path / "run.log").write_text("ticks\n16000\n17000\n")
    return f"{tmp_path / 'own.py'}:TICKS"


def test_a_format_in_a_file_is_read(own: str, tmp_path: Path) -> None:
    """Named as file.py:NAME it needs no registration; by content the file is taken for CSV."""
    log = read_render_log(tmp_path / "run.log", None, own)
    assert log.time("frame_ms").tolist() == [16.0, 17.0]
    assert log_format_of(tmp_path / "run.log") == "csv"
    with pytest.raises(InputError, match="expected no mapping"):
        read_render_log(tmp_path / "run.log", {"gpu_ms": "x"}, own)


def test_a_registered_format_is_one_of_ours(own: str, tmp_path: Path) -> None:
    """It is recognised before CSV takes what is left."""
    register_format("ticks", LOG_FORMATS.find(own))
    assert log_format_of(tmp_path / "run.log") == "ticks"
    assert read_render_log(tmp_path / "run.log").format == "ticks"
    with pytest.raises(InputError, match="did you mean ticks"):
        read_render_log(tmp_path / "run.log", None, "tics")


def test_what_is_no_format_is_not_registered(own: str) -> None:
    """Only a record of ours can be a format, under a name that is free."""
    with pytest.raises(InputError, match="name of its own"):
        register_format("csv", LOG_FORMATS.find(own))
    with pytest.raises(InputError, match="expected a LogFormat, got int"):
        register_format("ticks", 3)  # pyright: ignore[reportArgumentType]
