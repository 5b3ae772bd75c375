"""Width and height of a picture, as options tell them."""

from ...base.errors import InputError


def parse_size(text: str, option: str = "--size") -> tuple[int, int]:
    """Return width and height of ``WIDTHxHEIGHT``.

    Raises `InputError` if it is anything else.
    """
    width, _, height = text.partition("x")
    if all(
        side.isascii() and side.isdecimal() and 16 <= int(side) <= 16384 for side in (width, height)
    ):
        return int(width), int(height)
    raise InputError(f"{option}: expected WIDTHxHEIGHT from 16x16 to 16384x16384, got {text}")
