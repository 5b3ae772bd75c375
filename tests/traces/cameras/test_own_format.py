"""A camera-trace format that lodbench does not know, brought by its user."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.read_trace import FORMATS, format_of, read_trace, register_format
from lodbench.traces.cameras.trace_format import TraceFormat
from lodbench.traces.cameras.write_trace import write_trace

OWN = """
from pathlib import Path
import numpy as np
from lodbench.traces.cameras.samples import trace_from_samples
from lodbench.traces.cameras.trace_format import TraceFormat


def read(path, selector):
    rows = [line.split("|") for line in path.read_text().splitlines()[1:]]
    table = np.array(rows, dtype=float)
    upright = np.tile((0.0, 0.0, 0.0, 1.0), (len(table), 1))
    return trace_from_samples(
        path.stem, path, range(2, len(table) + 2),
        time_s=table[:, 0], position_m=table[:, 1:], orientation_xyzw=upright,
    )


def write(trace, path):
    rows = (f"{t}|{x}|{y}|{z}" for t, (x, y, z) in zip(trace.time_s, trace.position_m))
    path.write_text("\\n".join(["bars", *rows]))


BARS = TraceFormat("bars", lambda lines: lines[:1] == ["bars"], read, write, (".bars",))
"""
FILE = "bars\n0|0|0|1\n1|2|0|1\n"


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Return what names a format in a user's file, beside a trace in that format."""
    monkeypatch.setattr(FORMATS, "_users", {})
    (tmp_path / "own.py").write_text(OWN)
    (tmp_path / "walk.bars").write_text(FILE)
    return f"{tmp_path / 'own.py'}:BARS"


def check(trace: CameraTrace) -> None:
    """Check that a trace is the file's: two metres along x in a second."""
    assert trace.time_s.tolist() == [0.0, 1.0]
    assert trace.position_m.tolist() == [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0]]


def test_a_format_in_a_file_reads_and_writes(own: str, tmp_path: Path) -> None:
    """Named as file.py:NAME it needs no registration, and is recognised by nobody."""
    path = tmp_path / "walk.bars"
    trace = read_trace(str(path), own)
    check(trace)
    assert write_trace(trace, tmp_path / "again", own) == own
    check(read_trace(str(tmp_path / "again"), own))
    with pytest.raises(InputError, match="of a known format"):
        read_trace(str(path))


def test_a_registered_format_is_one_of_ours(own: str, tmp_path: Path) -> None:
    """It is recognised by content, and written by suffix."""
    register_format("bars", FORMATS.find(own))
    assert format_of(tmp_path / "walk.bars") == "bars"
    trace = read_trace(str(tmp_path / "walk.bars"))
    check(trace)
    assert write_trace(trace, tmp_path / "again.bars") == "bars"
    check(read_trace(str(tmp_path / "again.bars"), "bars"))


def test_what_is_no_format_is_not_registered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only a record of ours can be a format, under a name that is free."""
    monkeypatch.setattr(FORMATS, "_users", {})
    read_only = TraceFormat("nothing", lambda lines: False, lambda path, selector: read_trace(""))
    with pytest.raises(InputError, match="name of its own"):
        register_format("csv", read_only)
    with pytest.raises(InputError, match="expected a TraceFormat, got int"):
        register_format("bars", 3)  # pyright: ignore[reportArgumentType]
    register_format("nothing", read_only)
    trace = CameraTrace("x", np.zeros(1), np.zeros((1, 3)), np.eye(4)[3:], np.zeros(1, dtype=bool))
    with pytest.raises(InputError, match="a format to write out of"):
        write_trace(trace, Path("x"), "nothing")
