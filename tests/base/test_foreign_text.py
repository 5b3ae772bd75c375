"""What users' code returns or raises is told in one line, whatever it does when it is printed."""

import sys

import pytest

from lodbench.base.foreign_text import LONGEST, describe_error, describe_value, type_name


class UnprintableError(Exception):
    """An exception that raises when it is printed."""

    def __init__(self, kind: type[BaseException]) -> None:
        super().__init__()
        self.kind = kind

    def __str__(self) -> str:
        """Raise."""
        raise self.kind


class Lying(str):
    """Text that says of itself what it likes."""

    __slots__ = ()

    def split(self, *_: object) -> list[str]:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Raise."""
        raise SystemExit

    __len__ = __getitem__ = __iter__ = split  # pyright: ignore[reportAssignmentType]


class SaysLies:
    """An object whose text is of a class of its own."""

    def __str__(self) -> str:
        """Return the text."""
        return Lying("two\nlines")


class NamelessType(type):
    """A metaclass that gives classes another name at each look."""

    @property
    def __name__(cls) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        """Raise."""
        raise KeyboardInterrupt


class Nameless(metaclass=NamelessType):
    """A class that does not tell its name."""


@pytest.mark.parametrize(
    "kind", [ValueError, KeyboardInterrupt, SystemExit, GeneratorExit, RecursionError]
)
def test_what_raises_when_it_is_printed_is_described_by_its_type(
    kind: type[BaseException],
) -> None:
    """Whatever it raises, an exit and Ctrl-C among it."""
    assert describe_error(UnprintableError(kind)) == "UnprintableError"
    assert describe_value(UnprintableError(kind)) == "an unprintable UnprintableError"


def test_one_line_without_control_characters() -> None:
    """Lines are joined; what moves the cursor, turns the direction or cannot be sent is ``?``."""
    error = ValueError("first\n\t second\x1b[31m\x00\u202e\ud800")
    assert describe_error(error) == "ValueError: first second?[31m???"
    assert describe_error(ValueError()) == "ValueError"
    assert describe_error(ValueError(" \n ")) == "ValueError"


def test_long_texts_are_cut() -> None:
    """A gigabyte of text, or one of spaces, is no reason to print or to read it all."""
    assert describe_error(ValueError("x" * LONGEST)) == "ValueError: " + "x" * LONGEST
    assert describe_error(ValueError("x" * (LONGEST + 1))) == f"ValueError: {'x' * (LONGEST - 1)}…"
    assert describe_error(ValueError(" " * 10**6 + "x")) == "ValueError: …"
    assert describe_value(10**400) == "1" + 38 * "0" + "…"
    assert sys.get_int_max_str_digits() < 5000
    assert describe_value(10**5000) == "an unprintable int"


def test_methods_of_the_text_itself_are_not_called() -> None:
    """`str` of an object may be of a class whose every method raises."""
    assert describe_value(SaysLies()) == "two lines"


def test_names_of_types_are_told_as_they_were_given() -> None:
    """A metaclass's own name is not asked, and a long one with lines in it is cut to one."""
    assert type_name(Nameless()) == "Nameless"
    assert type_name(type("a\nb" * 100, (), {})()) == ("a b" * 100)[:39] + "…"
