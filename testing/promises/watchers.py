"""Watchers that change what a policy is shown, or that look at what it touches."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...policies.frame_times import Completed
from ...policies.protocol import Policy
from ...policies.selection import Selection
from ...policies.view import View
from ..examples.example import Notes


class Unstreamed(Notes):
    """A policy that gets no loader, so that everything is in memory without being said to be."""

    def __init__(self, policy: Policy) -> None:
        super().__init__(policy)
        type(self).capabilities = replace(self.capabilities, loader=False)


class AllResident(Unstreamed):
    """One that is told of every node that it is in memory."""

    def show(self, view: View) -> View:
        """Return the view with the loader's record of a scene that it has read."""
        everything = np.ones(len(view.scene), dtype=np.bool_)
        return replace(view.state, residency=everything).view(view.ids, view.xyz_m)


class Guarded(Notes):
    """A policy of which is noted what of a view it changed.

    Attributes
    ----------
    changed : list of (frame, what was changed in it)
    """

    def __init__(self, policy: Policy) -> None:
        super().__init__(policy)
        self.changed: list[tuple[int, str]] = []

    def select(self, view: View) -> Selection:
        """Compare the view with what it was before."""
        before = _contents(view)
        copies = {name: array.copy() for name, array in before.items()}
        selection = super().select(view)
        for name, array in _contents(view).items():
            if not np.array_equal(array, copies[name], equal_nan=True):
                self.changed.append((view.frame, name))
        return selection


def _contents(view: View) -> dict[str, np.ndarray]:
    """Return the arrays that a view is made of."""
    state = view.state
    parts: list[tuple[str, Any, tuple[str, ...]]] = [
        ("", view, ("ids", "xyz_m")),
        ("", state, ("centers_m", "last_detail", "inside")),
        ("completed.", state.completed, ("work_ms", "gpu_ms")),
        ("previous.", state.previous, ("ids", "detail") if state.previous else ()),
    ]
    return {f"{part}{name}": getattr(owner, name) for part, owner, names in parts for name in names}


class _Reports(Completed):
    """Reports of a timer that know whether anything was asked of them."""

    __slots__ = ("asked",)

    def __init__(self, times: FloatArray) -> None:
        super().__init__(times, len(times))
        object.__setattr__(self, "asked", False)

    def __getattribute__(self, name: str) -> Any:
        """Note that something is asked."""
        object.__setattr__(self, "asked", True)
        return super().__getattribute__(name)

    def __len__(self) -> int:
        """Return the number of reports, which is to ask something too."""
        return len(self.frame)


class FaultyTimer(Notes):
    """A policy that is shown reports by a faulty timer instead of the true ones."""

    def __init__(self, policy: Policy) -> None:
        super().__init__(policy)
        self._shown: list[_Reports] = []

    @staticmethod
    def reports(true: FloatArray) -> FloatArray:
        """Return what the timer says of frames that took (n, 4) milliseconds, (k, 4)."""
        return true

    def show(self, view: View) -> View:
        """Return the view with the reports of the faulty timer."""
        true = view.completed
        times = np.column_stack((true.cpu_ms, true.gpu_ms, true.work_ms, true.present_ms))
        rows = self.reports(times)
        self._shown.append(_Reports(rows))
        return replace(view.state, completed=self._shown[-1]).view(view.ids, view.xyz_m)

    def looks_at_timings(self) -> bool:
        """Return whether the policy has asked for any report."""
        return any(object.__getattribute__(shown, "asked") for shown in self._shown)


Fault = Callable[[FloatArray], FloatArray]
"""From the good reports, (n, 4), to what a faulty timer says of a frame after them, (k, 4)."""


def faulty_timer(good: int, fault: Fault) -> type[FaultyTimer]:
    """Return the watcher whose timer fails after so many good reports."""

    def reports(true: FloatArray) -> FloatArray:
        # The last digits of a timer that works never stand still.
        known = true[:good] * (1.0 + 1e-6 * (np.arange(len(true[:good])) % 7))[:, np.newaxis]
        return np.concatenate((known, *[fault(known)] * (len(true) - len(known))))

    return type("Faulty", (FaultyTimer,), {"reports": staticmethod(reports)})


FAULTS: dict[str, Fault] = {
    "silent": lambda _good: np.zeros((0, 4)),  # what the others may be no better than
    "missing": lambda _good: np.full((1, 4), np.nan),
    "zero": lambda _good: np.zeros((1, 4)),
    "stale": lambda good: good[-1:],
}
