"""Names of things: ours, a user's own, and what is refused."""

from pathlib import Path

import pytest

from lodbench.base.errors import InputError
from lodbench.base.name_registry import Registry


@pytest.fixture
def colors() -> Registry[int]:
    """Return two numbers of a module of the standard library, by names of ours."""
    return Registry("color", int, "xml", {"red": "dom:INDEX_SIZE_ERR", "blue": "dom:SYNTAX_ERR"})


def test_ours_are_imported_by_name(colors: Registry[int]) -> None:
    """Names come in the order of entry, and stand for what the module holds."""
    assert list(colors) == ["red", "blue"]
    assert (colors.find("red"), colors.find("blue")) == (1, 12)


def test_a_users_own_comes_first(colors: Registry[int]) -> None:
    """A registered thing is found by its name, before ours, and may be replaced by a new one."""
    colors.register("green", 5)
    colors.register("green", 6)
    assert list(colors) == ["green", "red", "blue"]
    assert colors.find("green") == 6
    assert "green" in colors
    assert len(colors) == 3


def test_a_users_file_needs_no_registration(colors: Registry[int], tmp_path: Path) -> None:
    """A file or module and a name in it say which thing is meant."""
    (tmp_path / "mine.py").write_text("PINK = 7\n")
    assert colors.find(f"{tmp_path / 'mine.py'}:PINK") == 7
    assert colors.find("xml.dom:NOT_FOUND_ERR") == 8


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "rad",
            "expected one of red, blue or your own as file.py:NAME, got rad; did you mean red?",
        ),
        ("zzz", "or your own as file.py:NAME, got zzz; name one of them"),
        ("absent.py:X", "absent.py: expected a Python file with a color, got no file"),
        ("absent_module:X", "color: absent_module: No module named 'absent_module'; is it"),
        (":X", "color: no module"),
        ("xml.dom:X", "color of xml.dom: expected one of Node, "),
        ("xml.dom:Node", "color xml.dom:Node: expected a int, got type"),
    ],
)
def test_what_no_name_stands_for_is_refused(colors: Registry[int], name: str, message: str) -> None:
    """The message says which names there are, or what is wrong with the user's own."""
    with pytest.raises(InputError) as caught:
        colors.find(name)
    assert message in str(caught.value)


def test_a_file_that_does_not_load_is_the_users_error(
    colors: Registry[int], tmp_path: Path
) -> None:
    """Whatever the file raises is told as an error of that file, with the line of bad syntax."""
    for text, message in (("1 +", ":1: expected"), ("raise SystemExit(3)", "SystemExit: 3")):
        (tmp_path / "mine.py").write_text(text)
        with pytest.raises(InputError, match=message):
            colors.find(f"{tmp_path / 'mine.py'}:X")


@pytest.mark.parametrize(
    ("name", "thing"), [("red", 3), ("a:b", 3), ("", 3), ("green", "no number")]
)
def test_names_of_ours_and_other_kinds_are_not_registered(
    colors: Registry[int], name: str, thing: object
) -> None:
    """Nobody takes a name away from ours, or enters what could not be used."""
    with pytest.raises(InputError):
        colors.register(name, thing)  # pyright: ignore[reportArgumentType]
    assert list(colors) == ["red", "blue"]
