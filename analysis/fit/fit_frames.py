"""Frames of one or several logs that measure one time."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray, FloatArray
from ...base.errors import InputError
from ...traces.logs.render_log import FIRST_FRAMES, Rejection, RenderLog, TimeName, measurable
from .drift import drawing_order


@dataclass(frozen=True, slots=True)
class Origin:
    """What was drawn in a log, and the occasion on which it was recorded."""

    scene: str
    occasion: str


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """Frames in the order of their logs, and of a log in the order in which they were drawn.

    Attributes
    ----------
    names : names of P predictors
    predictors : (n, P) float64
    time_ms : (n,) float64, > 0
    series : (n,) int64, which log a frame is of
    origins : of each log, where that is known; else all are of one scene, each on an occasion of
        its own
    path : (n,) int64 or None
        Place of a frame on its log's path, where frames were drawn in another order.
    """

    names: tuple[str, ...]
    predictors: FloatArray
    time_ms: FloatArray
    series: NDArray[np.int64]
    origins: tuple[Origin, ...] = ()
    path: NDArray[np.int64] | None = None

    def __len__(self) -> int:
        return len(self.time_ms)

    def rows(self, which: BoolArray | NDArray[np.int64]) -> "Sample":
        """Return some of the frames."""
        return Sample(
            self.names,
            self.predictors[which],
            self.time_ms[which],
            self.series[which],
            self.origins,
            None if self.path is None else self.path[which],
        )

    def origin(self, log: int) -> Origin:
        """Return where one of the logs is from."""
        return self.origins[log] if self.origins else Origin("", f"log {log}")

    def column(self, name: str) -> FloatArray:
        """Return one predictor, (n,)."""
        return self.predictors[:, self.names.index(name)]


def gather(
    logs: Sequence[RenderLog], names: Sequence[str], target: TimeName, first_frames: int | None
) -> tuple[Sample, tuple[Rejection, ...]]:
    """Return the frames of all logs that measure `target`, and the others by reason.

    Raises `InputError` if a log lacks the time or a predictor, or no frame is left.

    Parameters
    ----------
    first_frames
        Frames at the start of each log that are left out; None for `FIRST_FRAMES`, and none of a
        log whose header says ``rows: averages``.
    """
    parts: list[tuple[FloatArray, FloatArray, NDArray[np.int64]]] = []
    counts: dict[str, int] = {}
    for log in logs:
        first = _first_frames(log) if first_frames is None else first_frames
        keep, rejections = measurable(log, target, names, first_frames=first)
        drawn = drawing_order(log)
        drawn = drawn[keep[drawn]]
        path = _places(log)
        parts.append((log.columns(names)[drawn], log.time(target)[drawn], path[drawn]))
        for rejection in rejections:
            counts[rejection.reason] = counts.get(rejection.reason, 0) + rejection.count
    sizes = [len(part[1]) for part in parts]
    rejected = tuple(Rejection(count, reason) for reason, count in counts.items())
    if not sum(sizes):
        listed = "; ".join(map(str, rejected))
        raise InputError(
            f"{logs[0].name}: expected frames that measure {target}, got none ({listed})"
        )
    sample = Sample(
        tuple(names),
        np.vstack([part[0] for part in parts]),
        np.concatenate([part[1] for part in parts]),
        np.repeat(np.arange(len(logs)), sizes),
        tuple(_origin(log, place) for place, log in enumerate(logs)),
        np.concatenate([part[2] for part in parts]) if any(map(_shuffled, logs)) else None,
    )
    return sample, rejected


def _first_frames(log: RenderLog) -> int:
    averaged = dict(log.header).get("rows", "").startswith("averages")
    return 0 if averaged else FIRST_FRAMES


def _shuffled(log: RenderLog) -> bool:
    return "drawn_at" in log.recorded


def _places(log: RenderLog) -> NDArray[np.int64]:
    """Return the place of each row on the path, the same in both passes, (n,)."""
    again = np.nan_to_num(log.recorded.get("pass", np.zeros(len(log))))
    places = np.zeros(len(log), dtype=np.int64)
    for one in np.unique(again):
        rows = np.flatnonzero(again == one)
        places[rows] = np.arange(len(rows))
    return places


def _origin(log: RenderLog, place: int) -> Origin:
    header = dict(log.header)
    return Origin(header.get("scene", ""), header.get("occasion", f"log {place}"))
