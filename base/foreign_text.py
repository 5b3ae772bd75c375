"""Text about what users' code returns or raises, which may do anything when it is printed."""

LONGEST = 300
"""Characters of an exception that are told."""

_LONGEST_VALUE = 40
_NAME = type.__dict__["__name__"]  # a metaclass may have another


def describe_value(value: object) -> str:
    """Return a value in one short line; one that cannot be printed is described by its type."""
    text = _printed(value, _LONGEST_VALUE)
    return f"an unprintable {type_name(value)}" if text is None else text


def describe_error(error: BaseException) -> str:
    """Return type and text of an exception in one line of at most `LONGEST` characters or so."""
    text = _printed(error, LONGEST)
    return f"{type_name(error)}: {text}" if text else type_name(error)


def type_name(value: object) -> str:
    """Return the name of a value's type, in one short line."""
    return one_line(_NAME.__get__(type(value)), _LONGEST_VALUE)


def _printed(value: object, longest: int) -> str | None:
    try:
        return one_line(str(value), longest)
    except BaseException:  # noqa: BLE001 - users' code may raise KeyboardInterrupt here, or anything
        return None


def one_line(text: str, longest: int) -> str:
    """Return the beginning of a text; what moves a terminal's cursor or hides text becomes ``?``.

    Methods are those of `str` itself: the text may be of a class that has others.
    """
    words = " ".join(str.split(str.__getitem__(text, slice(4 * longest))))
    line = "".join(letter if letter.isprintable() else "?" for letter in words)
    cut = len(line) > longest or str.__len__(text) > 4 * longest
    return f"{line[: longest - 1]}…" if cut else line
