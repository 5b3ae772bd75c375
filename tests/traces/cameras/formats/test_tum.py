"""Reading and writing TUM trajectories."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.cameras.formats.tum import read_tum, write_tum
from lodbench.traces.cameras.generators.generate import generate
from lodbench.traces.cameras.orientation import view_direction


def test_optical_identity_looks_up_and_times_are_relative(tmp_path: Path) -> None:
    """An optical frame that is not turned looks along the world's +z."""
    path = tmp_path / "a.txt"
    path.write_text("# comment\n\n100.5 1 2 3 0 0 0 1\n101.0\t4 5 6 0 0 0 1\n")
    trace = read_tum(path)
    assert trace.origin_s == 100.5
    assert trace.time_s.tolist() == [0.0, 0.5]
    assert trace.position_m.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert np.allclose(view_direction(trace.orientation_xyzw), [0, 0, 1])
    assert trace.name == "a"


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("1 2 3 4 5 6 7", r"a.txt:2: expected 8 columns \(timestamp tx .*\), got 7"),
        ("1 2 3 4 5 6 7 8 9", "got 9"),
        ("1 0 0 nan 0 0 0 1", "a.txt:2: expected a finite number for tz, got 'nan'"),
        ("1 0 0 0 0 0 zero 1", "for qz, got 'zero'"),
        ("1 0 inf 0 0 0 0 1", "for ty, got 'inf'"),
    ],
)
def test_broken_rows_are_refused_with_their_line(tmp_path: Path, row: str, message: str) -> None:
    """Too few or many columns and what is no number name the line and the column."""
    path = tmp_path / "a.txt"
    path.write_text(f"0 0 0 0 0 0 0 1\n{row}\n")
    with pytest.raises(InputError, match=message):
        read_tum(path)


def test_a_selector_is_refused(tmp_path: Path) -> None:
    """A file that holds one trace has nothing to choose from."""
    with pytest.raises(InputError, match="expected no selector"):
        read_tum(tmp_path / "a.txt", "P01")


def test_written_trace_reads_back(tmp_path: Path) -> None:
    """Poses come back to the bit, times too while the origin is 0."""
    trace = generate("walk", duration_s=2.0, seed=3)
    path = tmp_path / "walk.txt"
    write_tum(trace, path)
    back = read_tum(path)
    assert np.array_equal(back.time_s, trace.time_s)
    assert np.array_equal(back.position_m, trace.position_m)
    assert np.array_equal(back.orientation_xyzw, trace.orientation_xyzw)


def test_cuts_cannot_be_written(tmp_path: Path) -> None:
    """The format has no place for teleports, so they are not lost in silence."""
    trace = generate("teleport", duration_s=10.0)
    with pytest.raises(InputError, match=r"expected a trace without cuts for TUM, got 3 cuts"):
        write_tum(trace, tmp_path / "a.txt")
