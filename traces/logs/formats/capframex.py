"""CapFrameX records: JSON, and CSV with lines ``//Key=Value`` above the columns of OCAT.

In the JSON, ``CaptureData`` is a struct of arrays by PresentMon's names of version 1, in which a
dropped frame has zeros for its display times.  ``CpuActive`` and ``GpuActive`` are PresentMon's
CPUBusy and GPUBusy.  A number that is none is the string ``"NaN"``, as Newtonsoft's serialiser has
it.  A file may hold several runs; they are separate captures, so one is read.

Source: CXWorld/CapFrameX, ``SessionCaptureData.cs`` and ``RecordManager.cs``.
"""

import hashlib
import math
import uuid
from dataclasses import replace
from pathlib import Path
from typing import Literal

import msgspec
import numpy as np

from ....base.arrays import BoolArray, FloatArray
from ....base.errors import InputError
from ....base.files.strict_json import read_json
from ....base.files.text_file import read_text
from ....base.files.whole_file import write_whole
from ..log_format import LogFormat, LogHead
from ..log_timings import log_from_timings
from ..timings import FrameTimings, complete_timings
from .presentmon import is_presentmon, open_present_table, read_present_table

_Numbers = list[float | Literal["NaN"]]
_ADVICE = "give a record that CapFrameX saved"


class _CaptureData(msgspec.Struct, rename="pascal", omit_defaults=True):
    time_in_seconds: _Numbers
    ms_between_presents: _Numbers
    dropped: list[bool] | None = None
    ms_in_present_a_p_i: _Numbers | None = msgspec.field(default=None, name="MsInPresentAPI")
    ms_between_display_change: _Numbers | None = None
    ms_until_render_complete: _Numbers | None = None
    ms_until_displayed: _Numbers | None = None
    present_mode: list[int] | None = None
    allows_tearing: list[int] | None = None
    sync_interval: list[int] | None = None
    animation_error: _Numbers | None = None
    gpu_active: _Numbers | None = None
    cpu_active: _Numbers | None = None


# Of `FrameTimings`, where CapFrameX has it.
_FIELDS = {
    "present_s": "time_in_seconds",
    "between_presents_ms": "ms_between_presents",
    "in_present_ms": "ms_in_present_a_p_i",
    "between_display_change_ms": "ms_between_display_change",
    "until_render_complete_ms": "ms_until_render_complete",
    "until_displayed_ms": "ms_until_displayed",
    "animation_error_ms": "animation_error",
    "gpu_busy_ms": "gpu_active",
    "cpu_busy_ms": "cpu_active",
}
# Of a dropped frame, CapFrameX has zeros for these.
_OF_SHOWN = ("between_display_change_ms", "until_displayed_ms")


class _Run(msgspec.Struct, rename="pascal"):
    capture_data: _CaptureData
    hash: str | None = None
    present_mon_runtime: str | None = None


class _Info(msgspec.Struct, rename="pascal", omit_defaults=True):
    id: str | None = None
    process_name: str | None = None
    game_name: str | None = None
    comment: str | None = None
    processor: str | None = None
    gpu: str | None = msgspec.field(default=None, name="GPU")
    creation_date: str | None = None


class _Session(msgspec.Struct, rename="pascal"):
    runs: list[_Run]
    info: _Info | None = None
    hash: str | None = None


def read_capframex(path: str | Path, *, run: int = 0) -> FrameTimings:
    """Read one run of a CapFrameX record, JSON or CSV.

    Raises `InputError` if the file is no such record, its arrays differ in length, its times
    decrease, or there is no such run.

    Parameters
    ----------
    run
        Which run of a JSON record, from 0.
    """
    source = Path(path)
    if read_text(source).lstrip()[:1] == "{":
        return _read_json(source, run)
    table, notes = open_present_table(source)
    if run != 0:
        raise InputError(f"expected run 0, since a CSV holds one, got {run}", path=path)
    pairs = tuple(tuple(part.strip() for part in text.split("=", 1)) for text in table.comments)
    header = tuple((pair[0], pair[1]) for pair in pairs if len(pair) == 2)
    return replace(read_present_table(table, notes=notes, dialect="capframex"), header=header)


def _read_json(path: Path, run: int) -> FrameTimings:
    session = read_json(path, _Session, "a record of CapFrameX", _ADVICE)
    if not 0 <= run < len(session.runs):
        raise InputError(
            f"expected a run from 0 to {len(session.runs) - 1}, got {run}; choose one", path=path
        )
    known, dropped = _arrays(session.runs[run].capture_data, path)
    info = session.info or _Info()
    pairs: dict[str, str | None] = msgspec.to_builtins(info)
    several = len(session.runs) > 1
    return complete_timings(
        known,
        dropped,
        dialect="capframex",
        application=info.process_name or "",
        process_id=-1,
        swap_chain="",
        header=tuple((key, value) for key, value in pairs.items() if value),
        notes=(f"read run {run} of {len(session.runs)}",) if several else (),
    )


def _arrays(data: _CaptureData, path: Path) -> tuple[dict[str, FloatArray], BoolArray]:
    lists: dict[str, _Numbers | None] = {
        name: getattr(data, field) for name, field in _FIELDS.items()
    }
    frames = len(data.time_in_seconds)
    if frames == 0:
        raise InputError("expected at least one frame, got none; record again", path=path)
    dropped = data.dropped if data.dropped is not None else [False] * frames
    lengths = {name: len(values) for name, values in lists.items() if values is not None}
    for name, length in {**lengths, "dropped": len(dropped)}.items():
        if length != frames:
            raise InputError(
                f"expected {frames} values of {name} as of time, got {length}; {_ADVICE}", path=path
            )
    known = {name: np.array(v, dtype=np.float64) for name, v in lists.items() if v is not None}
    for name, values in known.items():
        if np.isinf(values).any():
            raise InputError(f"expected finite numbers of {name}, got inf; {_ADVICE}", path=path)
    _require_order(known["present_s"], path)
    return known, np.array(dropped, dtype=np.bool_)


def _require_order(time_s: FloatArray, path: Path) -> None:
    wrong = np.flatnonzero(~(np.diff(time_s) >= 0.0))
    if wrong.size or not np.isfinite(time_s[0]):
        row = int(wrong[0]) + 1 if wrong.size else 0
        message = f"expected times that never decrease, got {time_s[row]} at frame {row}; {_ADVICE}"
        raise InputError(message, path=path)


def write_capframex(
    path: str | Path,
    timings: FrameTimings,
    *,
    comment: str = "",
    sync_interval: int = 0,
    tearing: bool = False,
) -> None:
    """Write one stream as a CapFrameX record with one run, whose time starts at 0.

    Hashes and id follow from the numbers, so that the same timings give the same bytes.

    Raises `InputError` if the file cannot be written.
    """
    frames = len(timings)
    columns = {name: getattr(timings, name) for name in _FIELDS}
    columns["present_s"] = timings.present_s - timings.present_s[0]
    for name in _OF_SHOWN:
        columns[name] = np.where(timings.dropped, 0.0, columns[name])
    data = _CaptureData(
        **{field: _list(columns[name]) for name, field in _FIELDS.items()},
        dropped=timings.dropped.tolist(),
        present_mode=[0] * frames,
        allows_tearing=[int(tearing)] * frames,
        sync_interval=[sync_interval] * frames,
    )
    digest = hashlib.sha1(msgspec.json.encode(data), usedforsecurity=False).hexdigest()
    info = _Info(
        id=str(uuid.UUID(digest[:32])),
        process_name=timings.application,
        game_name=timings.application.removesuffix(".exe"),
        comment=comment,
    )
    session = _Session([_Run(data, digest, "Other")], info, digest)
    write_whole(Path(path), msgspec.json.encode(session))


def _list(values: FloatArray) -> _Numbers:
    return ["NaN" if math.isnan(value) else value for value in values.tolist()]


def _recognises(head: LogHead) -> bool:
    if head.text.startswith("{"):
        return '"CaptureData"' in head.text or '"Runs"' in head.text
    return head.text.startswith("//") and is_presentmon(head.header)


FORMAT = LogFormat(
    "CapFrameX, JSON or CSV; times only",
    _recognises,
    lambda path, _: log_from_timings(read_capframex(path), path.stem),
    predictors=False,
)
