"""Writing traces whole or not at all."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.cameras.generators.generate import generate
from lodbench.traces.cameras.read_trace import read_trace
from lodbench.traces.cameras.write_trace import write_trace


@pytest.mark.parametrize(
    ("file", "format_name", "written"),
    [
        ("a.csv", None, "csv"),
        ("a.PARQUET", None, "parquet"),
        ("a.txt", None, "tum"),
        ("a.tum", None, "tum"),
        ("a.txt", "csv", "csv"),
    ],
)
def test_format_comes_from_the_name_or_is_named(
    tmp_path: Path, file: str, format_name: str | None, written: str
) -> None:
    """A suffix decides unless a format is given; what was written is read back."""
    trace = generate("walk", duration_s=1.0)
    assert write_trace(trace, tmp_path / file, format_name) == written
    assert np.array_equal(read_trace(str(tmp_path / file)).position_m, trace.position_m)
    assert [path.name for path in tmp_path.iterdir()] == [file]


@pytest.mark.parametrize(
    ("file", "format_name", "message"),
    [
        ("a.dat", None, "expected a name that ends in .csv, .parquet, .txt, .tum, got 'a.dat'"),
        ("a.csv", "kitti", "a format to write out of csv, parquet, tum, got 'kitti'"),
        ("absent/a.csv", None, "expected a path that can be written, got No such file"),
    ],
)
def test_what_cannot_be_written_is_refused(
    tmp_path: Path, file: str, format_name: str | None, message: str
) -> None:
    """An unknown suffix, a format that is only read, and a folder that is not there."""
    with pytest.raises(InputError, match=message):
        write_trace(generate("walk", duration_s=1.0), tmp_path / file, format_name)
    assert not list(tmp_path.iterdir())


def test_a_failed_write_keeps_the_old_file(tmp_path: Path) -> None:
    """The target changes only when the new file is complete, and nothing else is left."""
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(InputError, match="without cuts"):
        write_trace(generate("teleport", duration_s=10.0), path)
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.txt"]
