"""JSON files read into typed records, with errors that say where."""

import json
from pathlib import Path
from typing import Any, NoReturn, TypeVar

import msgspec

from .errors import InputError
from .text_file import read_text

T = TypeVar("T")


def read_json(path: Path, kind: type[T], advice: str) -> T:
    """Return the content of a JSON file as a record of this kind.

    Raises `InputError` if the file is no text, no JSON (with the line), or not of this form (with
    the place).

    Parameters
    ----------
    advice
        What to do about a file of another form, for the message.
    """
    text = read_text(path)
    try:
        content: Any = json.loads(text, parse_constant=_refuse)
    except json.JSONDecodeError as error:
        raise InputError(
            f"expected JSON, got an error in column {error.colno}: {error.msg}; {advice}",
            path=path,
            line=error.lineno,
        ) from error
    except (ValueError, RecursionError) as error:
        raise InputError(f"expected JSON, got {error}; {advice}", path=path) from error
    try:
        return msgspec.convert(content, kind)
    except msgspec.ValidationError as error:
        raise InputError(f"expected another form of JSON: {error}; {advice}", path=path) from error


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant}, which JSON does not have")
