"""MangoHud's CSV.

Above the header stand a line of names (``os,cpu,gpu,…``) and one of values, with ``log_versioning``
also the version and two titles.  ``frametime`` is microseconds up to 0.6.8 and milliseconds from
0.6.9 on; since most files do not say their version, the unit is the one in which fps times
frametime makes a second.  ``elapsed`` is nanoseconds.  Files before 0.6 have ``fps`` alone.

Source: flightlessmango/MangoHud 0.8.4, ``src/logging.cpp``; 0.6.8 and 0.6.9, ``src/overlay.cpp``.
"""

import re
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from ....base.arrays import FloatArray
from ....base.errors import InputError
from ..log_cells import number_of
from ..log_format import LogFormat, LogHead
from ..log_table import LogTable, log_lines, read_log_bytes, split_table
from ..render_log import ColumnSource, RenderLog

_SYSTEM = "os,cpu,gpu,"
_HEADER_WITHIN = 12  # lines
_NARROWEST, _WIDEST = 8, 17  # columns, of 0.6 and of 0.8.4


def read_mangohud(path: Path) -> RenderLog:
    """Return the log of a file; it has times and no predictors.

    Raises `InputError` if the file is a summary, has no rows or no fps, or no number where one is
    expected.
    """
    data = read_log_bytes(path)
    lines = [line.strip() for line in log_lines(data, _HEADER_WITHIN)]
    if lines[0].startswith("0.1% Min FPS"):
        message = "expected a log with one row a frame, got MangoHud's summary; give the log itself"
        raise InputError(message, path=path, line=1)
    at = next((i for i, line in enumerate(lines) if line.startswith("fps,")), None)
    if at is None and _is_headless(lines[0]):
        names = ["fps", "frametime", *(f"column {i}" for i in range(3, lines[0].count(",") + 1))]
        data, at = f"{','.join([*names, 'elapsed'])}\n".encode() + data, 0
        lines = []
    if at is None:
        message = "expected a header that begins with fps below the system's description"
        raise InputError(f"{message}, got none; is the file cut off?", path=path, line=len(lines))
    table = split_table(data, path, skip=at)
    frame_ms, note = _frame_ms(table)
    notes = (note,) if lines else (note, "no header: columns are by their places")
    elapsed = [table.header.index("elapsed")] if "elapsed" in table.header else []
    return RenderLog(
        name=path.stem,
        format="mangohud",
        predictors=(),
        counts=np.empty((len(frame_ms), 0)),
        frame_ms=frame_ms,
        time_s=table.numbers(elapsed)[:, 0] / 1e9 if elapsed else None,
        header=_system(lines[:at]),
        notes=notes,
        sources=(
            ColumnSource("frame_ms", "frametime" if "frametime" in table.header else "fps", "ms"),
        ),
    )


def _frame_ms(table: LogTable) -> tuple[FloatArray, str]:
    fps = table.numbers([table.header.index("fps")])[:, 0]
    if "frametime" not in table.header:
        with np.errstate(divide="ignore"):
            return 1e3 / fps, "frame_ms is 1000 / fps, since the file has no frametime"
    frametime = table.numbers([table.header.index("frametime")])[:, 0]
    with np.errstate(over="ignore", invalid="ignore"):  # fps may be infinite, and frametime 0
        product = fps * frametime
    product = product[np.isfinite(product) & (product > 0.0)]
    # Between 1,000 (milliseconds) and 1,000,000 (microseconds), in the middle of the logarithms.
    if len(product) and np.median(product) > 10**4.5:
        return frametime / 1e3, "frame_ms is frametime in us, as MangoHud up to 0.6.8 writes it"
    return frametime, "frame_ms is frametime in ms, as MangoHud from 0.6.9 on writes it"


def _system(lines: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Return the system's description and the version that stand above the header."""
    pairs: list[tuple[str, str]] = []
    for above, line in pairwise(lines):
        if above.startswith(_SYSTEM):
            pairs += zip(above.split(","), line.split(","), strict=False)
        elif re.fullmatch(r"v\d+", above):
            pairs.append(("version", line))
    return tuple(pairs)


def _recognises(head: LogHead) -> bool:
    marks = (_SYSTEM, "0.1% Min FPS", "fps,frametime,")  # the second of a summary, refused
    if any(line.startswith(marks) for line in head.lines[:_HEADER_WITHIN]):
        return True
    return len(head.lines) > 1 and all(map(_is_headless, head.lines[:2]))


def _is_headless(line: str) -> bool:
    """Return whether a row without a header is MangoHud's: a dozen numbers, fps and its inverse."""
    fields = line.split(",")
    if not _NARROWEST <= len(fields) <= _WIDEST:
        return False
    numbers = [number_of(field, "thousands") for field in fields]
    if any(number is None for number in numbers):
        return False
    fps, frametime = (number or 0.0 for number in numbers[:2])
    return any(0.97 < fps * frametime / second < 1.03 for second in (1e3, 1e6))


FORMAT = LogFormat(
    "MangoHud; times only", _recognises, lambda path, _: read_mangohud(path), predictors=False
)
