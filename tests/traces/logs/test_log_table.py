"""Tables in text: what is read fast is read right, and what is wrong is said with its line."""

import time
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.traces.logs.log_table import arrow_numbers, exact_numbers, read_log_bytes, split_table

NAN = float("nan")
GOOD = "# note\na,b,c\n1,2.5,x\n3,NA,y\n"


def table_of(text: str):
    """Split a text into header and rows."""
    return split_table(text.encode(), Path("log.csv"))


def test_comments_header_and_rows_are_told_apart():
    """Lines of comment and blank lines stand before the header; missing values are NaN."""
    table = table_of("# note\n\n// more\n a , b,c\n1,2.5,x\n\n3,NA,y\n")
    assert table.comments == ("note", "more")
    assert table.header == ("a", "b", "c")
    assert table.numbers([1, 0]).tolist()[0] == [2.5, 1.0]
    assert np.isnan(table.numbers([1])[1, 0])
    assert table.texts(2) == ["x", "y"]


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_delimiters_are_found_in_the_header(delimiter: str):
    """Commas, semicolons and tabs all separate columns."""
    table = table_of("a,b\n1,2\n".replace(",", delimiter))
    assert table.numbers([0, 1]).tolist() == [[1.0, 2.0]]


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        ("a,b\n1;2\n3;4\n", 2, "got 1; rows must use the delimiter of the header"),
        ("a,b\n1,5,2,5\n", 2, "got 4; decimal commas, or thousands?"),
        ("a,b\n1,2,574,766\n2,1,237,097\n", 2, "got 4; decimal commas, or thousands?"),
        ("a,b\n1;2\n", 2, "got 1"),
        ("a,b\neins,zwei\n", 2, "expected numbers in column a, got such as 'eins'"),
        ("a,b\n", 1, "expected rows below the header, got none"),
        ("a,b\n\n  \n", 1, "expected rows below the header, got none"),
        ("1,2\n3,4\n", 1, "expected a header row with names, got numbers"),
        ("# only\n# comments\n", 2, "expected a header row, got only comments"),
        ("just words\n1\n", 1, "expected columns separated by commas, semicolons or tabs"),
    ],
)
def test_each_fault_has_its_line_and_its_advice(text: str, line: int, says: str):
    """The message says where, what was expected and what to do."""
    with pytest.raises(InputError) as caught:
        table_of(text).numbers([0, 1])
    assert caught.value.line == line
    assert says in caught.value.message
    assert caught.value.path == "log.csv"


def test_line_ends_of_any_kind_and_mixed(tmp_path: Path):
    """Windows, old Macintosh and Unix ends in one file make no difference."""
    path = tmp_path / "mixed.csv"
    path.write_bytes(b"a,b\r\n1,2\n3,4\r5,6\r\n")
    table = split_table(read_log_bytes(path), path)
    assert table.numbers([0, 1]).tolist() == [[1, 2], [3, 4], [5, 6]]


@pytest.mark.parametrize(
    ("text", "numbers", "says"),
    [
        ("a,b\n1,zwei\n3,4\n", [[1, NAN], [3, 4]], "1 cell of b is no number, such as 'zwei'"),
        ("a,b\n1,inf\n3,4\n", [[1, NAN], [3, 4]], "1 cell of b is no number, such as 'inf'"),
        ('a;b\n"1,5";2\n3;4\n', [[1.5, 2], [3, 4]], ""),
        ("a;b\n7,459;2\n3,1;4\n", [[7.459, 2], [3.1, 4]], ""),
        ('a,b\n"1,234,567",2\n3,4\n', [[1234567, 2], [3, 4]], ""),
        ('a,b\n"1,234",2\n3,4\n', [[1234, 2], [3, 4]], ""),
        ("a,b\n1 234 567,2\n3,4\n", [[1234567, 2], [3, 4]], ""),
        ("a,b\n1,2\na,b\n3,4\n", [[1, 2], [3, 4]], "the header stands 1 more times"),
        ("a,b\n1,2\n3\n5,6\n", [[1, 2], [5, 6]], "1 of 3 rows have too few or too many"),
        ("a,b,c\n1,2\n3,4,5\n", [[1, 2], [3, 4]], ""),
        ("a,b\n1,2,late\n3,4\n", [[1, 2], [3, 4]], ""),
        ("a,b\n1,2,9\n3,4\n5,6\n7,8\n", [[3, 4], [5, 6], [7, 8]], "left aside"),
        ("a,b,c\n1,2,3\n3,4", [[1, 2]], "the last row is cut off and left aside"),
        ("a,b,\n1,2,\n3,4,\n", [[1, 2], [3, 4]], ""),
    ],
)
def test_odd_cells_and_rows_are_missing_counted_and_named(
    text: str, numbers: list[list[float]], says: str
):
    """What is no number is missing, and said; what is one in another habit is read."""
    values, notes = table_of(text).measure([0, 1])
    np.testing.assert_array_equal(values, numbers)
    assert bool(notes) == bool(says)
    assert says in "; ".join(notes)


def test_columns_of_numbers_are_told_from_others():
    """A column of words, and an empty one, are not of numbers; one with some gaps is."""
    table = table_of("a,b,c,d\n1,x,,NA\n2,y,,3\n")
    assert table.numeric([0, 1, 2, 3]) == [0, 3]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_marked_encodings_are_read(tmp_path: Path, encoding: str):
    """A byte order mark says what the bytes are and is no part of the first name."""
    path = tmp_path / "marked.csv"
    path.write_bytes("a,b\n1,2\n".encode(encoding))
    assert split_table(read_log_bytes(path), path).header == ("a", "b")


cells = st.sampled_from(["1", "-2.5", "1e3", " 7 ", "NA", "", "nan", "0", "inf", '"4"'])


@given(st.lists(st.lists(cells, min_size=3, max_size=3), min_size=1, max_size=20))
def test_the_fast_pass_agrees_with_the_exact_one(rows: list[list[str]]):
    """Arrow and the pass in Python give the same numbers, NaN for NaN."""
    text = "a,b,c\n" + "".join(f"{','.join(row)}\n" for row in rows) + "1,2,3\n"
    table = table_of(text)
    exact, _ = exact_numbers(table, [0, 2])
    exact[np.isinf(exact)] = np.nan
    fast = arrow_numbers(table, [0, 2])
    if fast is not None:
        np.testing.assert_array_equal(np.where(np.isinf(fast), np.nan, fast), exact)
    np.testing.assert_array_equal(table.numbers([0, 2]), exact)


def test_plain_numbers_take_the_fast_pass():
    """An ordinary log never needs the slow pass."""
    assert arrow_numbers(table_of("a,b\n1,2.5\n3,NA\n"), [0, 1]) is not None


@given(st.text(max_size=200))
def test_any_text_gives_numbers_or_an_input_error(text: str):
    """No other exception comes out of a damaged file."""
    try:
        values = table_of(f"a,b\n{text}").numbers([0, 1])
    except InputError as error:
        message = error.message
    else:
        message = ""
        assert values.shape[1] == 2
    assert "\n" not in message


def test_a_header_of_delimiters_is_no_work():
    """80,000 of them in 160 kB took 16 s, as each was taken off a copy of the rest."""
    began = time.process_time()
    table = table_of(f"gpu_ms{',' * 81_000}\n1{',' * 81_000}\n")
    assert time.process_time() - began < 1.0
    assert table.header == ("gpu_ms",)
