"""The native CSV and Parquet: exact round trips and clear errors."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import parquet

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace, Repair
from lodbench.traces.cameras.formats.native_csv import read_csv, write_csv
from lodbench.traces.cameras.formats.native_parquet import MOST_POSES, read_parquet, write_parquet

HEADER = "time_s,x_m,y_m,z_m,qx,qy,qz,qw,cut\n"


def random_trace(seed: int, count: int, name: str) -> CameraTrace:
    """Trace of random numbers over many magnitudes, with cuts, an origin and repairs."""
    rng = np.random.default_rng(seed)
    quaternions = rng.normal(size=(count, 4))
    return CameraTrace(
        name,
        np.append(0.0, np.cumsum(10.0 ** rng.uniform(-4.0, 1.0, count - 1))),
        rng.normal(size=(count, 3)) * 10.0 ** rng.uniform(-300.0, 6.0, (count, 3)),
        quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True),
        np.append(np.array([False]), rng.random(count - 1) < 0.2),
        origin_s=float(rng.normal() * 1e9),
        repairs=(Repair(3, "repeated timestamps dropped"),),
        fovy_deg=float(rng.uniform(1.0, 179.0)) if seed % 2 else None,
    )


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
@given(seed=st.integers(0, 2**32 - 1), count=st.integers(1, 20), name=st.text(max_size=8))
def test_round_trip_keeps_every_bit(
    tmp_path_factory: pytest.TempPathFactory, suffix: str, seed: int, count: int, name: str
) -> None:
    """Samples, cuts, name, origin, repairs and field of view come back as they were."""
    write, read = {
        "csv": (write_csv, read_csv),
        "parquet": (write_parquet, read_parquet),
    }[suffix]
    trace = random_trace(seed, count, name.encode("utf-8", "ignore").decode())
    path = tmp_path_factory.mktemp("native") / f"t.{suffix}"
    write(trace, path)
    back = read(path)
    assert np.array_equal(back.time_s, trace.time_s)
    assert np.array_equal(back.position_m, trace.position_m)
    assert np.array_equal(back.orientation_xyzw, trace.orientation_xyzw)
    assert np.array_equal(back.cut, trace.cut)
    assert (back.name, back.origin_s, back.repairs) == (trace.name, trace.origin_s, trace.repairs)
    assert back.fovy_deg == trace.fovy_deg


def test_csv_by_hand_needs_neither_record_nor_cut(tmp_path: Path) -> None:
    """Columns in any order, comments, Windows line ends and a late start are fine."""
    path = tmp_path / "mine.csv"
    path.write_bytes(
        b"\xef\xbb\xbf# my walk\r\nqw, qx,qy,qz,time_s,x_m,y_m,z_m\r\n"
        b"1,0,0,0,5.0,1,2,3\r\n\r\n1,0,0,0,5.5,4,5,6\r\n"
    )
    trace = read_csv(path)
    assert trace.time_s.tolist() == [0.0, 0.5]
    assert trace.position_m.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert (trace.name, trace.origin_s, trace.cut.any()) == ("mine", 5.0, False)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time_s,x_m\n0,0\n", "t.csv:1: expected the columns time_s x_m .*, got time_s x_m"),
        (HEADER.replace("cut", "cuts") + "0,0,0,0,0,0,0,1,0\n", "got cuts qw"),
        (HEADER.replace("y_m", "x_m"), "t.csv:1: expected the columns"),
        (HEADER, "at least one sample"),
        (HEADER + "0,0,0,0,0,0,0,1,2\n", "t.csv:2: expected cut to be 0 or 1, got 2"),
        (HEADER + "0,0,0,0,0,0,0,1\n", "t.csv:2: expected 9 columns"),
        (HEADER + "0,0,NaN,0,0,0,0,1,0\n", "t.csv:2: expected a finite number for y_m, got 'NaN'"),
        ("# lodbench.trace/1 {oops\n" + HEADER, "t.csv:1: expected a header of lodbench"),
        (
            '# lodbench.trace/1 {"name":3}\n' + HEADER,
            "t.csv:1: expected a header of lodbench",
        ),
        ("# lodbench.trace/9 {}\n" + HEADER, "t.csv:1: expected version 1 of lodbench.trace, got"),
        ("\n# nothing\n", "expected the columns"),
    ],
)
def test_broken_csv_is_refused(tmp_path: Path, text: str, message: str) -> None:
    """Columns, values and the record are checked and named with their line."""
    path = tmp_path / "t.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        read_csv(path)


def write_table(path: Path, schema: str = "lodbench.trace/1", **changed: object) -> None:
    """Parquet file of two still samples with some columns replaced (None: left out)."""
    columns: dict[str, object] = {
        name: [0.0, 0.0] for name in ("x_m", "y_m", "z_m", "qx", "qy", "qz")
    }
    columns |= {"time_s": [0.0, 1.0], "qw": [1.0, 1.0], **changed}
    kept = {name: values for name, values in columns.items() if values is not None}
    table = pa.table(kept).replace_schema_metadata({"lodbench.schema": schema})
    parquet.write_table(table, path)


def test_parquet_of_other_tools_needs_only_schema_and_columns(tmp_path: Path) -> None:
    """Whole-number columns and a missing cut are fine; the name is the file's."""
    path = tmp_path / "mine.parquet"
    write_table(path, x_m=[1, 2])
    trace = read_parquet(path)
    assert trace.position_m[:, 0].tolist() == [1.0, 2.0]
    assert (trace.name, len(trace.repairs)) == ("mine", 0)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"schema": "lodbench.trace/2"}, "expected the schema lodbench.trace/1, got lodbench.tr"),
        ({"x_m": None}, "expected the columns"),
        ({"y_m": ["a", "b"]}, "expected numbers in column y_m, got string"),
        ({"y_m": [0.0, None]}, "t.parquet:2: expected a finite number for y_m"),
        ({"time_s": [1.0, 0.0]}, "t.parquet:2: expected times in order"),
        ({"time_s": [[1.0], [0.0]]}, "expected numbers in column time_s"),
    ],
)
def test_broken_parquet_is_refused(
    tmp_path: Path, changed: dict[str, object], message: str
) -> None:
    """Another schema, missing columns, text, nulls and disorder are named."""
    path = tmp_path / "t.parquet"
    schema = str(changed.pop("schema", "lodbench.trace/1"))
    write_table(path, schema, **changed)
    with pytest.raises(InputError, match=message):
        read_parquet(path)


def test_a_parquet_of_millions_of_poses_is_refused_before_it_is_decoded(tmp_path: Path) -> None:
    """Zeros take 40 kB a million, and some 300 bytes a pose once they are a path."""
    path = tmp_path / "t.parquet"
    zeros = np.zeros(MOST_POSES + 1)
    same = dict.fromkeys(("time_s", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw"), zeros)
    write_table(path, **same)
    assert path.stat().st_size < 200_000
    with pytest.raises(InputError, match="at most 1,000,000 poses, got 1,000,001; split the trace"):
        read_parquet(path)


def test_a_record_with_an_impossible_field_of_view_is_refused(tmp_path: Path) -> None:
    """180 degrees and more see nothing on a plane."""
    path = tmp_path / "t.csv"
    write_csv(replace(random_trace(1, 3, "a"), fovy_deg=50.0), path)
    assert read_csv(path).fovy_deg == 50.0
    path.write_text(path.read_text().replace('"fovy_deg":50.0', '"fovy_deg":180'))
    with pytest.raises(InputError, match="fovy_deg: expected degrees above 0 and below 180"):
        read_csv(path)
