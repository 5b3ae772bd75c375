"""What the two native formats share: columns, schema name and the record beside the samples."""

from pathlib import Path

import msgspec

from ...base.errors import InputError
from ...base.strict_json import decode_json
from .camera_trace import CameraTrace, Repair

SCHEMA = "lodbench.trace/1"
REQUIRED = ("time_s", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")
COLUMNS = (*REQUIRED, "cut")


class Header(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a native file says beside its samples."""

    name: str
    origin_s: float = 0.0
    repairs: tuple[tuple[int, str], ...] = ()

    def made_repairs(self) -> tuple[Repair, ...]:
        """Repairs as a trace holds them."""
        return tuple(Repair(count, what) for count, what in self.repairs)


def encode_header(trace: CameraTrace) -> bytes:
    """JSON of a trace's header."""
    repairs = tuple((repair.count, repair.what) for repair in trace.repairs)
    return msgspec.json.encode(Header(trace.name, trace.origin_s, repairs))


def decode_header(data: bytes | str, path: Path, line: int | None) -> Header:
    """Header from its JSON.

    Raises `InputError` if it is not the JSON of a header.
    """
    data = data.encode() if isinstance(data, str) else data
    what, advice = f"a header of {SCHEMA}", "remove it or write the file again"
    return decode_json(data, Header, what, advice, path=path, first_line=line)


def check_columns(columns: list[str], path: Path, line: int | None) -> None:
    """Raise `InputError` unless the columns are the required ones, once each, and maybe cut."""
    names = sorted(columns)
    if names not in (sorted(REQUIRED), sorted(COLUMNS)):
        raise InputError(
            f"expected the columns {' '.join(REQUIRED)} and perhaps cut, got "
            f"{' '.join(names)[:200] or 'none'}; rename or remove columns",
            path=path,
            line=line,
        )
