"""What is printed of an error."""

import pickle

from lodbench.base.errors import InputError


def test_an_error_is_one_line_whatever_a_library_explains() -> None:
    """Reasons of other libraries may have several lines; the command line prints one."""
    error = InputError(
        "expected Parquet, got a bad page:\n  no such type: \n\n; write it", path="a"
    )
    assert str(error) == "a: expected Parquet, got a bad page: no such type: ; write it"


def test_an_error_comes_back_whole_from_another_process() -> None:
    """Path and line are not lost between a worker and who started it."""
    error = pickle.loads(pickle.dumps(InputError("expected a number", path="a.csv", line=3)))
    assert str(error) == "a.csv:3: expected a number"
