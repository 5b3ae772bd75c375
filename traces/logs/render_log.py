"""Render logs: what was drawn in each frame, and how long it took.

Every frame of the file is kept.  Which of them can serve as measurements depends on the time that
is asked about, so `measurable` says it for one time column and counts what it leaves out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from ...base.arrays import BoolArray, FloatArray, frozen_array
from ...base.errors import InputError
from ...base.predictors import CPU_PREDICTORS, GPU_PREDICTORS
from .timings import FrameTimings

TimeName = Literal["frame_ms", "gpu_ms", "cpu_ms"]

TIMES: tuple[TimeName, ...] = ("frame_ms", "gpu_ms", "cpu_ms")

COUNTS = tuple(dict.fromkeys((*GPU_PREDICTORS, *CPU_PREDICTORS)))
"""What the columns of a log may count, each name once."""

REFERENCES = ("reference_before_ms", "reference_after_ms")
"""The time of one fixed draw before and after a frame's."""

RECORDED = (
    "trace_s",
    *REFERENCES,
    "lag_ms",
    "drawn_at",
    "pass",
)
"""What `lodbench record` writes beside times and counts, each under this very name.

The time of one fixed draw before and after a frame's; from input to completion; the place of the
frame in the order of drawing; and which of two times the frame was drawn.
"""

# Compilation and first uploads: real times, but of work that no predictor counts.  In logs of
# llvmpipe the first three frames take up to three times what later ones with as much to draw do.
FIRST_FRAMES = 3

# A 32-bit counter of ns, µs or 100 ns ticks that ran over, as OpenGL's timer query before its
# first result: 2^32 ns = 4294.967 ms, and so on.
_WRAPPED_MS = (2.0**32 / 1e6, 2.0**31 / 1e6, 2.0**32 / 1e4, 2.0**32 / 1e3)


@dataclass(frozen=True, slots=True)
class Rejection:
    """Frames left out for one reason."""

    count: int
    reason: str

    def __str__(self) -> str:
        return f"{self.count} {self.reason}"


@dataclass(frozen=True, slots=True)
class ColumnSource:
    """Where a column of a log comes from.

    Attributes
    ----------
    name : as lodbench calls it
    source : the column of the file, or how it is calculated
    unit : of the file, as ``us``, ``count``, or ``count x 1e+06``
    why : how the unit was found, '' where the name says it
    """

    name: str
    source: str
    unit: str
    why: str = ""

    def __str__(self) -> str:
        return f"{self.name} is {self.source} in {self.why or self.unit}"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class RenderLog:
    """One value of each column per frame, in the order of the file.

    Attributes
    ----------
    name : what tables call it
    format : the format it was read as
    predictors : names of P columns, each of `COUNTS`, or one type's part of it, such as
        ``triangles[tree]``
    counts : (n, P) float64, NaN where the file has none
    frame_ms, gpu_ms, cpu_ms : (n,) float64 or None, NaN where the file has none
    time_s : (n,) float64 or None
        Time of the frame on the log's own clock.
    header : pairs of key and value from the file's comments or metadata
    notes : what the reader assumed or left aside, one sentence each
    warnings : of the notes, those that a user should act on
    sources : where each column comes from
    unused : columns of numbers in the file that serve nothing
    timings : what a tool that times presents measured of them, or None
    recorded : (n,) float64 by name, those of `RECORDED` that the file has
    """

    name: str
    format: str
    predictors: tuple[str, ...]
    counts: FloatArray
    frame_ms: FloatArray | None = None
    gpu_ms: FloatArray | None = None
    cpu_ms: FloatArray | None = None
    time_s: FloatArray | None = None
    header: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    sources: tuple[ColumnSource, ...] = ()
    unused: tuple[str, ...] = ()
    timings: FrameTimings | None = None
    recorded: Mapping[str, FloatArray] = field(default_factory=dict[str, FloatArray])

    def __post_init__(self) -> None:
        frames, width = len(self.counts), len(self.predictors)
        shapes = {"counts": (frames, width), **dict.fromkeys((*TIMES, "time_s"), (frames,))}
        for name, shape in shapes.items():
            values = getattr(self, name)
            if values is not None:
                frozen = frozen_array(values, np.float64, shape, f"render log {name}")
                object.__setattr__(self, name, frozen)
        recorded = {
            name: frozen_array(values, np.float64, (frames,), f"render log {name}")
            for name, values in self.recorded.items()
        }
        object.__setattr__(self, "recorded", recorded)
        unknown = [name for name in self.predictors if name.partition("[")[0] not in COUNTS]
        if unknown or len(set(self.predictors)) != width:
            raise InputError(f"render log: expected distinct known predictors, got {unknown}")
        if frames == 0:
            raise InputError("render log: expected at least one frame, got none")

    def __len__(self) -> int:
        return len(self.counts)

    def __repr__(self) -> str:
        times = ", ".join(self.times) or "no times"
        predictors = f"{len(self.predictors):,} predictors"
        return f"<RenderLog {self.name}: {len(self):,} frames, {times}, {predictors}>"

    @property
    def times(self) -> tuple[TimeName, ...]:
        """Names of the times that the log has."""
        return tuple(name for name in TIMES if getattr(self, name) is not None)

    def time(self, name: TimeName) -> FloatArray:
        """Return a column of times in milliseconds, (n,).

        Raises `InputError` if the log has no such time.
        """
        values = getattr(self, name, None)
        if values is None:
            have = ", ".join(self.times) or "none"
            raise InputError(f"{self.name}: expected the time {name}, got a log with {have}")
        return values

    def columns(self, names: Sequence[str]) -> FloatArray:
        """Return predictors side by side, (n, len(names)).

        Raises `InputError` if the log lacks one, naming all that are missing and all that are
        there.
        """
        missing = [name for name in names if name not in self.predictors]
        if missing:
            have = ", ".join(self.predictors) or "no predictors at all"
            raise InputError(
                f"{self.name}: expected the predictors {', '.join(missing)}, got a log with "
                f"{have}; map the columns that hold them, or fit fewer terms"
            )
        return self.counts[:, [self.predictors.index(name) for name in names]]


def measurable(
    log: RenderLog, target: TimeName, names: Sequence[str], *, first_frames: int = FIRST_FRAMES
) -> tuple[BoolArray, tuple[Rejection, ...]]:
    """Return which frames measure `target` against predictors, (n,), and the others by reason.

    A frame is counted once, for the first reason that holds.

    Raises `InputError` if the log lacks the time or a predictor.
    """
    time, counts = log.time(target), log.columns(names)
    wrapped = np.zeros(len(log), dtype=np.bool_)
    for limit in _WRAPPED_MS:
        wrapped |= np.abs(time - limit) < 1e-6 * limit
    reasons = (
        (f"{target} that is missing or not finite", ~np.isfinite(time)),
        (f"{target} that is zero or negative", ~(time > 0.0)),
        (f"{target} of a timer that ran over", wrapped),
        ("a predictor that is missing or negative", ~(counts >= 0.0).all(axis=1)),
        ("a predictor that is not finite", ~np.isfinite(counts).all(axis=1)),
        (f"first frames (1 to {first_frames})", np.arange(len(log)) < first_frames),
    )
    left = np.ones(len(log), dtype=np.bool_)
    rejections: list[Rejection] = []
    for reason, bad in reasons:
        count = int((left & bad).sum())
        left &= ~bad
        if count:
            rejections.append(Rejection(count, reason))
    return left, tuple(rejections)
