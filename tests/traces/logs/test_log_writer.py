"""Render logs are written as they are read, whole or not at all."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.logs.log_writer import check_log_path, write_log
from lodbench.traces.logs.read_log import log_format_of, read_render_log

COLUMNS = {
    "draw_calls": np.array([3, 5, 8]),
    "triangles": np.array([1_000.0, 16_777_216.0, 250.0]),
    "frame_ms": np.array([8.25, 16.123456, 33.3]),
    "cpu_ms": np.array([1.0, np.nan, 3.0]),
}
HEADER = {"renderer": "A card", "policy": "file.py:Class:a=1", "note": "one; two"}


@pytest.mark.parametrize(("name", "written"), [("log.csv", "csv"), ("log.parquet", "parquet")])
def test_what_was_written_is_read_back(tmp_path: Path, name: str, written: str) -> None:
    """Counts, times, gaps in them, and the header, in which a semicolon became a comma."""
    path = tmp_path / name
    write_log(path, COLUMNS, HEADER)
    assert log_format_of(path) == written
    log = read_render_log(path)
    assert log.predictors == ("draw_calls", "triangles")
    assert log.counts[:, 0].tolist() == [3.0, 5.0, 8.0]
    assert log.counts[:, 1].tolist() == [1_000.0, 16_777_216.0, 250.0]
    assert log.time("frame_ms") == pytest.approx(COLUMNS["frame_ms"], rel=1e-7)
    assert log.time("cpu_ms") == pytest.approx(COLUMNS["cpu_ms"], nan_ok=True)
    assert dict(log.header) == {**HEADER, "note": "one, two"}
    assert [file.name for file in tmp_path.iterdir()] == [name]


def test_the_csv_itself(tmp_path: Path) -> None:
    """A line about the log, the names of the columns, then a row a frame, whole numbers as such."""
    write_log(tmp_path / "log.csv", COLUMNS, {"renderer": "A card"})
    assert (tmp_path / "log.csv").read_text(encoding="utf-8").splitlines() == [
        "# renderer: A card",
        "draw_calls,triangles,frame_ms,cpu_ms",
        "3,1000,8.25,1",
        "5,16777216,16.123456,nan",
        "8,250,33.3,3",
    ]


@pytest.mark.parametrize("name", ["log.txt", "log", "log.CSV", "no/log.csv", "folder.csv"])
def test_paths_that_cannot_be_written(tmp_path: Path, name: str) -> None:
    """Another suffix, a folder that is not there, and a folder in place of the file."""
    (tmp_path / "folder.csv").mkdir()
    refusal = r"expected a \.parquet or \.csv file in a folder"
    with pytest.raises(InputError, match=refusal):
        check_log_path(tmp_path / name)
    with pytest.raises(InputError, match=refusal):
        write_log(tmp_path / name, COLUMNS, {})
    assert [file.name for file in tmp_path.iterdir()] == ["folder.csv"]


def test_a_path_of_another_writer(tmp_path: Path) -> None:
    """Who writes Parquet only asks for no other."""
    check_log_path(tmp_path / "frames.parquet", (".parquet",))
    with pytest.raises(InputError, match=r"expected a \.parquet file in a folder"):
        check_log_path(tmp_path / "frames.csv", (".parquet",))


@pytest.mark.parametrize("name", ["log.csv", "log.parquet"])
def test_columns_of_unequal_length_leave_what_was_there(tmp_path: Path, name: str) -> None:
    """A fault in the middle of writing neither replaces an earlier file nor leaves a part."""
    path = tmp_path / name
    path.write_text("earlier", encoding="utf-8")
    with pytest.raises(ValueError, match=r"zip\(\)|length"):
        write_log(path, {**COLUMNS, "gpu_ms": np.ones(2)}, HEADER)
    assert path.read_text(encoding="utf-8") == "earlier"
    assert [file.name for file in tmp_path.iterdir()] == [name]
