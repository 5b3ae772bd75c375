"""Paths of several players who share a screen."""

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from ...base.errors import InputError
from .camera_trace import CameraTrace

MOST_PLAYERS = 4


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class SharedScreen(CameraTrace):
    """The path of one player, and beside it those of the others, on one clock.

    Attributes
    ----------
    others : tuple of CameraTrace
        As long as the path itself.
    """

    others: tuple[CameraTrace, ...] = ()

    def __reduce__(self) -> tuple[type[CameraTrace], tuple[object, ...]]:
        return SharedScreen, (*_fields(self), self.others)

    def stretch(self, start_s: float = 0.0, end_s: float | None = None) -> CameraTrace:
        """Return the part between two times of every player's path; see `CameraTrace.stretch`."""
        first = CameraTrace.stretch(self, start_s, end_s)
        if first is self:
            return self
        return share(first, [other.stretch(start_s, end_s) for other in self.others])


def split(trace: CameraTrace) -> list[CameraTrace]:
    """Return the paths of all players, each on its own."""
    if not isinstance(trace, SharedScreen):
        return [trace]
    return [CameraTrace(*_fields(trace)), *trace.others]


def share(first: CameraTrace, others: Sequence[CameraTrace]) -> SharedScreen:
    """Return a player's path with those of others, all of one length, beside it."""
    return SharedScreen(*_fields(first), others=tuple(others))


def together(traces: Sequence[CameraTrace]) -> CameraTrace:
    """Return the path of the first of one to four players, with the others beside it.

    All begin at once, and what is longer than the shortest is cut off.

    Raises `InputError` if there are no players, more than four, or some already share a screen.
    """
    if not 1 <= len(traces) <= MOST_PLAYERS or any(
        isinstance(trace, SharedScreen) for trace in traces
    ):
        raise InputError(
            f"players: expected 1 to {MOST_PLAYERS} paths of one player each, got {len(traces)}"
        )
    if len(traces) == 1:
        return traces[0]
    length_s = min(trace.duration_s for trace in traces)
    if length_s > 0.0:
        first, *others = (trace.stretch(0.0, length_s) for trace in traces)
    else:  # where one has a single pose, all stand at their first
        first, *others = traces
    name = " + ".join(trace.name for trace in traces)
    return replace(share(first, others), name=name)


def _fields(trace: CameraTrace) -> list[Any]:
    return [getattr(trace, item.name) for item in fields(CameraTrace) if item.init]
