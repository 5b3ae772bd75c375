"""The frame log's schema."""

from pathlib import Path

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.sim.frame_log import COUNTS, TIMES, UNLOGGED, CountRows, FrameLog, LogHeader
from lodbench.sim.frame_log_file import read_frame_log, write_frame_log

HEADER = LogHeader("policy", "scene", "trace", "machine", 10.0, 0, "immediate", 60.0, 1e9)


def test_columns_by_name() -> None:
    """Times and counts are found by the names of the schema, which are distinct."""
    times = np.arange(2 * len(TIMES)).reshape(2, -1)
    counts = np.arange(2.0 * len(COUNTS)).reshape(2, -1)
    log = FrameLog(HEADER, times, counts)
    assert len(log) == 2
    assert len({*TIMES, *COUNTS}) == len(TIMES) + len(COUNTS)
    for i, name in enumerate(TIMES):
        assert log[name].tolist() == times[:, i].tolist()
    for i, name in enumerate(COUNTS):
        assert log[name].tolist() == counts[:, i].tolist()
    with pytest.raises(KeyError):
        log["frame_rate"]
    with pytest.raises(ValueError, match="read-only"):
        log.counts[0, 0] = 1.0


def test_nodes_by_depth_are_columns_behind_the_others(tmp_path: Path) -> None:
    """A tree's log has one a depth, in memory and in its file; another scene's has none."""
    times, counts = np.zeros((2, len(TIMES)), dtype=np.int64), np.zeros((2, len(COUNTS)))
    log = FrameLog(HEADER, times, counts, np.array([[1, 0, 4], [0, 2, 8]]))
    assert log.columns[-3:] == ("drawn_depth_0", "drawn_depth_1", "drawn_depth_2")
    assert log["drawn_depth_2"].tolist() == [4, 8]
    write_frame_log(tmp_path / "a.parquet", log)
    assert read_frame_log(tmp_path / "a.parquet").drawn_by_depth.tolist() == [[1, 0, 4], [0, 2, 8]]
    flat = FrameLog(HEADER, times, counts)
    assert flat.drawn_by_depth.shape == (2, 0)
    assert flat.columns == TIMES + COUNTS


@pytest.mark.parametrize(
    ("times", "counts"),
    [((2, len(TIMES)), (3, len(COUNTS))), ((2, 4), (2, len(COUNTS))), ((2, len(TIMES)), (2, 4))],
)
def test_tables_of_another_shape_are_refused(
    times: tuple[int, int], counts: tuple[int, int]
) -> None:
    """Rows must agree, and columns be those of the schema."""
    with pytest.raises(InputError, match="frame log: expected 5 times and"):
        FrameLog(HEADER, np.zeros(times, dtype=np.int64), np.zeros(counts))


def test_rows_are_given_by_name() -> None:
    """Whatever the order of names, values land in their columns; what is constant in none."""
    names = [*reversed(COUNTS), *UNLOGGED]
    rows = CountRows(names)
    for frame in range(2):
        rows.append(tuple(100.0 * frame + k for k in range(len(names))))
    table = rows.table()
    assert table.shape == (2, len(COUNTS))
    assert table[0].tolist() == list(range(len(COUNTS)))[::-1]
    assert (table[1] - table[0]).tolist() == [100.0] * len(COUNTS)


def test_rows_of_other_names_are_refused() -> None:
    """A name that is missing, and one that is no column, are named."""
    names = [*COUNTS, *UNLOGGED]
    with pytest.raises(KeyError, match="lag_ms"):
        CountRows([*names, "lag_ms"])
    names.remove("toggles")
    with pytest.raises(KeyError, match="toggles"):
        CountRows(names)


def test_a_row_of_another_length_is_refused() -> None:
    """A frame with a value too few, or too many, is not taken for one of other columns."""
    rows = CountRows([*COUNTS, *UNLOGGED])
    for count in (len(COUNTS), len(COUNTS) + len(UNLOGGED) + 1):
        with pytest.raises(ValueError, match="values a frame"):
            rows.append((0.0,) * count)
    assert len(rows.table()) == 0
