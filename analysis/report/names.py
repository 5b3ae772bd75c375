"""Names that users gave, as a page shows them: text of a length that can be read."""

from collections.abc import Iterable

_LONG, _HEAD = 80, 30
_MOST = 500
"""Characters of a name under the pointer, where it is cut."""


def short_name(name: str) -> str:
    """Return a name, cut in its middle where it is too long to read: files differ in their ends."""
    return name if len(name) <= _LONG else f"{name[:_HEAD]}…{name[_HEAD + 1 - _LONG :]}"


def whole_name(name: str) -> str:
    """Return what stands under the pointer of a name that was cut; nothing where it was not."""
    return "" if len(name) <= _LONG else name[:_MOST]


def readable(text: str, names: Iterable[str]) -> str:
    """Return a text with those of the names cut that are too long."""
    for name in sorted({name for name in names if len(name) > _LONG}, key=len, reverse=True):
        text = text.replace(name, short_name(name))
    return text
