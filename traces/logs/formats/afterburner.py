"""MSI Afterburner's hardware monitoring log, ``.hml`` or ``.csv``: samples, not frames.

Line ``0,`` is the version, ``1,`` the GPU, ``2,`` the names padded with blanks, ``3,`` an axis
each, and ``80, DATE, values…`` a sample every polling period, a second by default.  Its
``Frametime`` is that of some frame near the sample, so that few frames in a hundred are there.

Written from files; the format has no document.
"""

from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from ....base.errors import InputError
from ..log_cells import OddCells, comma_style, number_of
from ..log_format import LogFormat, LogHead
from ..log_table import read_log_bytes
from ..render_log import ColumnSource, RenderLog

INSTEAD = (
    "MSI Afterburner samples about once a second; for every frame record with PresentMon or "
    "CapFrameX, and for a cost model log draw calls and triangles in the engine"
)

_NAMES, _SAMPLE = "2", "80"
_DATES = ("%d-%m-%Y %H:%M:%S", "%Y-%m-%d %H:%M:%S", "%m/%d/%Y %H:%M:%S")


def read_afterburner(path: Path) -> RenderLog:
    """Return the samples of a log; it has times and no predictors.

    Raises `InputError` if it has no sample, or no frame time or frame rate.
    """
    rows = [
        [field.strip() for field in line.split(",")]
        for line in read_log_bytes(path).decode("utf-8").split("\n")
    ]
    names = next((row[2:] for row in rows if row[0] == _NAMES), list[str]())
    samples = [row for row in rows if row[0] == _SAMPLE and len(row) > 2]
    source = next((name for name in ("Frametime", "Framerate") if name in names), None)
    if source is None:
        held = ", ".join(name for name in names if name)[:80] or "no columns"
        message = f"expected Frametime or Framerate of MSI Afterburner, got {held}"
        raise InputError(f"{message}; {INSTEAD}", path=path)
    if not samples:
        raise InputError(f"expected samples, got none; {INSTEAD}", path=path)
    at = names.index(source) + 2
    cells = [row[at] if at < len(row) else "" for row in samples]
    commas, odd = comma_style(cells, ";"), OddCells()
    values = np.full(len(cells), np.nan)
    for row, cell in enumerate(cells):
        number = number_of(cell, commas)
        if number is None:
            odd.add(source, cell)
        else:
            values[row] = number
    if source == "Framerate":
        values = np.divide(1e3, values, out=np.full(len(values), np.nan), where=values > 0.0)
    gpu = next((row[2] for row in rows if row[0] == "1" and len(row) > 2), "")
    return RenderLog(
        name=path.stem,
        format="afterburner",
        predictors=(),
        counts=np.empty((len(values), 0)),
        frame_ms=values,
        time_s=_seconds([row[1] for row in samples]),
        header=(("tool", "MSI Afterburner"), ("gpu", gpu)),
        notes=(f"frame_ms is {source} of MSI Afterburner, a sample each polling period",),
        warnings=(INSTEAD, *odd.notes()),
        sources=(ColumnSource("frame_ms", source, "ms" if source == "Frametime" else "fps"),),
        unused=tuple(dict.fromkeys(name for name in names if name and name != source)),
    )


def _seconds(texts: list[str]) -> np.ndarray | None:
    """Return the samples' seconds since the first, or None where dates are of no known form."""
    for form in _DATES:
        try:
            times = [datetime.strptime(text, form).replace(tzinfo=UTC) for text in texts]
        except ValueError:
            continue
        return np.array([(time - times[0]).total_seconds() for time in times])
    return None


def _recognises(head: LogHead) -> bool:
    return any("Hardware monitoring log" in line for line in head.lines[:3])


FORMAT = LogFormat(
    "MSI Afterburner's log; sampled times only",
    _recognises,
    lambda path, _: read_afterburner(path),
    predictors=False,
)
