"""What is printed of an error."""

import pickle

import pytest

from lodbench.base.errors import LONGEST, InputError, about_file, require_between


def test_an_error_is_one_line_whatever_a_library_explains() -> None:
    """Reasons of other libraries may have several lines; the command line prints one."""
    error = InputError(
        "expected Parquet, got a bad page:\n  no such type: \n\n; write it", path="a"
    )
    assert str(error) == "a: expected Parquet, got a bad page: no such type: ; write it"


def test_a_line_with_the_name_of_its_file_is_short() -> None:
    """The name of the file is whole, and what to do at the end; the middle is left out."""
    line = str(InputError("expected one of " + "abc, " * 80 + "; name one", path="p" * 100))
    assert len("error: " + line) == LONGEST
    assert line.startswith("p" * 100 + ": expected one of ")
    assert line.endswith("; name one")


def test_an_error_comes_back_whole_from_another_process() -> None:
    """Path and line are not lost between a worker and who started it."""
    error = pickle.loads(pickle.dumps(InputError("expected a number", path="a.csv", line=3)))
    assert str(error) == "a.csv:3: expected a number"


def test_an_error_of_a_block_is_about_its_file() -> None:
    """The file is named, the line kept; an error that names another file stays as it is."""
    with pytest.raises(InputError, match=r"^a\.toml:3: no$"), about_file("a.toml"):
        raise InputError("no", line=3)
    with pytest.raises(InputError, match=r"^b\.toml: no$"), about_file("a.toml"):
        raise InputError("no", path="b.toml")


@pytest.mark.parametrize(
    ("value", "high", "message"),
    [
        (0, 4, "count: expected 1 to 4, got 0"),
        (5, 4, "count: expected 1 to 4, got 5"),
        (float("nan"), 4, "count: expected 1 to 4, got nan"),
        (0, float("inf"), "count: expected at least 1, got 0"),
    ],
)
def test_numbers_out_of_range_are_refused(value: float, high: float, message: str) -> None:
    """Both bounds belong to the range."""
    require_between(1, 1, high, "count")
    require_between(4, 1, high, "count")
    with pytest.raises(InputError, match=message):
        require_between(value, 1, high, "count")
