"""What the two native formats share: columns, schema name and the record beside the samples."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...base.errors import InputError
from ...base.files.strict_json import decode_json
from .camera_trace import CameraTrace, Repair
from .samples import trace_from_samples

SCHEMA = "lodbench.trace/1"
REQUIRED = ("time_s", "x_m", "y_m", "z_m", "qx", "qy", "qz", "qw")
COLUMNS = (*REQUIRED, "cut")


class Header(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a native file says beside its samples."""

    name: str
    origin_s: float = 0.0
    repairs: tuple[tuple[int, str], ...] = ()
    fovy_deg: float | msgspec.UnsetType = msgspec.UNSET


def encode_header(trace: CameraTrace) -> bytes:
    """JSON of a trace's header."""
    repairs = tuple((repair.count, repair.what) for repair in trace.repairs)
    fovy_deg = msgspec.UNSET if trace.fovy_deg is None else trace.fovy_deg
    return msgspec.json.encode(Header(trace.name, trace.origin_s, repairs, fovy_deg))


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
        message = (
            f"expected the columns {' '.join(REQUIRED)} and perhaps cut, got "
            f"{' '.join(names)[:200] or 'none'}; rename or remove columns"
        )
        raise InputError(message, path=path, line=line)


def columns_of(trace: CameraTrace) -> dict[str, FloatArray | BoolArray]:
    """Columns of a trace by their names."""
    numbers = np.column_stack([trace.time_s, trace.position_m, trace.orientation_xyzw])
    return dict(zip(COLUMNS, (*numbers.T.copy(), trace.cut), strict=True))


def trace_of(
    columns: Mapping[str, FloatArray], header: Header, path: Path, lines: Sequence[int]
) -> CameraTrace:
    """Trace of columns of numbers; raises as `trace_from_samples`."""
    required = np.column_stack([columns[name] for name in REQUIRED])
    if header.fovy_deg is not msgspec.UNSET and not 0.0 < header.fovy_deg < 180.0:
        message = f"fovy_deg: expected degrees above 0 and below 180, got {header.fovy_deg}"
        raise InputError(f"{message}; correct or remove it", path=path)
    trace = trace_from_samples(
        header.name,
        path,
        lines,
        time_s=required[:, 0],
        position_m=required[:, 1:4],
        orientation_xyzw=required[:, 4:8],
        cut=columns["cut"] != 0.0 if "cut" in columns else None,
        origin_s=header.origin_s,
        repairs=tuple(Repair(count, what) for count, what in header.repairs),
    )
    stated = header.fovy_deg
    return trace if stated is msgspec.UNSET else replace(trace, fovy_deg=stated)
