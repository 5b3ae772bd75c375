"""Records as JSON: written, and read strictly, so that mistakes are told with line or place."""

from pathlib import Path
from typing import TypeVar

import msgspec

from ..errors import InputError
from .text_file import read_text

T = TypeVar("T")


def read_json(path: Path, kind: type[T], what: str, advice: str) -> T:
    """Return the content of a JSON file as `decode_json`; raises as it and `read_text`."""
    text = read_text(path, advice=advice)
    return decode_json(text.encode(), kind, what, advice, path=path, first_line=1)


def encode_record(record: object) -> bytes:
    """Return the JSON of a dataclass with a field `schema`, indented, its schema first."""
    fields: dict[str, object] = msgspec.to_builtins(record)
    ordered = {"schema": fields.pop("schema"), **fields}
    return msgspec.json.format(msgspec.json.encode(ordered), indent=1) + b"\n"


def decode_json(
    data: bytes,
    kind: type[T],
    what: str,
    advice: str,
    *,
    path: Path | None = None,
    first_line: int | None = None,
) -> T:
    """Return JSON as a record of this kind.

    Raises `InputError` if it is no JSON, or not of this form; with the place, as ``$.runs[0]``.

    Parameters
    ----------
    what, advice
        What was expected and what to do, for the message.
    first_line
        The line of the file on which `data` begins, if the file is text.
    """
    try:
        return msgspec.json.decode(data, type=kind)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        reason, _, byte = str(error).partition(" (byte ")
        at = int(byte.rstrip(")")) if byte else len(data)
        snippet = data[at : at + 20].decode(errors="replace")
        reason += f" at {snippet!r}" if snippet else ""
        if isinstance(error, RecursionError):
            reason = "brackets nested too deep"
        # Of JSON in another form only the place in it is known, and that not as a line.
        unknown = isinstance(error, (RecursionError, msgspec.ValidationError)) and b"\n" in data
        line = first_line
        if first_line is not None:
            line = None if unknown else first_line + data.count(b"\n", 0, at)
        raise InputError(
            f"expected {what} as JSON, got {reason}; {advice}", path=path, line=line
        ) from error
