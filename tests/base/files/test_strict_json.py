"""JSON into records, and where it is wrong."""

from dataclasses import dataclass
from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import decode_json, read_json


@dataclass(frozen=True, slots=True)
class Run:
    """A record as readers have them."""

    times: list[float]


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ('{"times":\n[1,,2]}', 2, "got JSON is malformed: invalid character at ',2]}'"),
        ('{"times":\n[1, NaN]}', 2, "at 'NaN]}'"),
        ('{"times":\n[1,\n2', 3, "truncated"),
        ('{"times": []}\n x', 2, "trailing characters"),
        ('{"times":\n[1, "a"]}', None, "Expected `float`, got `str` - at `$.times[1]`"),
        ('{"times": [1e999]}', 1, "out of range"),
        ("[" * 100_000, 1, "Expected `object`, got `array`"),
        ('{"more":' * 100_000, 1, "brackets nested too deep"),
    ],
)
def test_what_is_no_such_record(tmp_path: Path, text: str, line: int | None, message: str) -> None:
    """Broken JSON has its line, another form its place, and both say what to do."""
    path = tmp_path / "run.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_json(path, Run, "a run", "write it again")
    assert caught.value.message.startswith("expected a run as JSON, got ")
    assert message in caught.value.message
    assert caught.value.message.endswith("; write it again")
    assert (caught.value.path, caught.value.line) == (str(path), line)


def test_json_within_a_file_has_the_line_of_that_file() -> None:
    """A header on the third line of a text that breaks there is on line 3; in bytes it has none."""
    for first, line in ((3, 3), (None, None)):
        with pytest.raises(InputError) as caught:
            decode_json(b"{", Run, "a run", "write it again", first_line=first)
        assert caught.value.line == line


def test_what_is_right_is_read(tmp_path: Path) -> None:
    """With a byte order mark, as some editors leave it."""
    path = tmp_path / "run.json"
    path.write_bytes(b'\xef\xbb\xbf{"times": [1, 2.5]}')
    assert read_json(path, Run, "a run", "write it again") == Run([1.0, 2.5])
