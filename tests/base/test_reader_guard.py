"""The guard around readers: one line for any exception, and no warning of a library."""

import warnings
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from lodbench.base import errors
from lodbench.base.errors import InputError
from lodbench.base.files.parquet_file import ParquetColumns
from lodbench.base.reader_guard import guarded


@pytest.mark.parametrize(
    ("error", "says"),
    [
        (KeyError("x"), "cannot be read (KeyError: 'x'); write it again"),
        (RecursionError(), "nested too deep"),
        (MemoryError(), "that fits into memory"),
        (ImportError("No module named 'x'"), "No module named 'x'; install lodbench anew"),
        (OSError(5, "Input/output error"), "got Input/output error; check the path"),
        (InputError("expected a, got b"), "f.log: expected a, got b"),
    ],
)
def test_any_exception_is_one_line_with_the_path(error: Exception, says: str):
    """What a reader did not think of ends as bad input."""
    with pytest.raises(InputError) as caught, guarded("f.log", "a log"):
        raise error
    assert says in str(caught.value)
    assert str(caught.value).startswith("f.log:")


def test_an_interruption_passes():
    """Ctrl-C is no damage of the file."""
    with pytest.raises(KeyboardInterrupt), guarded("f.log", "a log"):
        raise KeyboardInterrupt


def test_warnings_of_libraries_are_swallowed():
    """Neither numpy nor a parser speaks to the user about a file."""
    with guarded("f.log", "a log"):
        warnings.warn("odd", UserWarning, stacklevel=1)
        assert np.float64(1.0) / np.float64(0.0) == np.inf


def test_messages_are_short_and_printable():
    """The middle of a long one is left out, not what to do; nothing moves the cursor."""
    error = InputError("expected a\x1b[2J\x07b" + "c" * 1_000 + "; do this", path="a\nb\x1b.csv")
    assert len(error.message) <= errors.LONGEST
    assert error.message.endswith("; do this")
    assert error.message.startswith("expected a?[2J?b")
    assert str(error).isprintable()


def test_a_small_file_of_many_rows_is_refused_before_it_is_decoded(tmp_path: Path):
    """Run lengths make 40 million values of a few kB; the refusal says how many there are."""
    path = tmp_path / "bomb.parquet"
    schema = pa.schema([("a", pa.float64())])
    zeros = pa.table({"a": pa.array(np.zeros(1_000_000))})
    with pq.ParquetWriter(path, schema) as writer:
        for _ in range(5):
            writer.write_table(zeros)
    assert path.stat().st_size < 100_000
    with pytest.raises(InputError, match="got 5,000,000 rows of 1 columns"):
        ParquetColumns(path)
