"""Files written whole or not at all."""

from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.whole_file import whole_text_file


def test_replaces_what_was_there(tmp_path: Path) -> None:
    """The file holds what was written, line ends as given, and nothing is beside it."""
    path = tmp_path / "out.txt"
    path.write_text("old")
    with whole_text_file(path) as file:
        file.write("new\n")
        assert path.read_text() == "old"
    assert path.read_bytes() == b"new\n"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("interruption", [ValueError, KeyboardInterrupt])
def test_interruption_leaves_the_old_file(
    tmp_path: Path, interruption: type[BaseException]
) -> None:
    """An error or Ctrl-C in the middle leaves what was there, and nothing beside it."""
    path = tmp_path / "out.txt"
    path.write_text("old")

    def write_half() -> None:
        with whole_text_file(path) as file:
            file.write("half")
            raise interruption

    with pytest.raises(interruption):
        write_half()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_device_is_not_replaced() -> None:
    """Renaming onto /dev/null would leave a plain file in its place."""
    with (
        pytest.raises(InputError, match="null: expected a file, got a folder or device"),
        whole_text_file(Path("/dev/null")),
    ):
        pass
    assert Path("/dev/null").is_char_device()
