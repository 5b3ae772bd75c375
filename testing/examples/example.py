"""A small world in which a promise is tried, and what a policy did in it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, Generic, TypeVar

import numpy as np

from ...base.arrays import BoolArray
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.protocol import Clairvoyant, Policy, Truth
from ...policies.selection import Selection
from ...policies.shared.observer import Watched, watch
from ...policies.view import View
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace

Factory = Callable[[], Policy]
"""A policy class, or a function without arguments that makes a policy."""


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """What a policy saw of a frame and what it selected, copied from what may change later."""

    view: View
    selection: Selection

    @property
    def pose(self) -> tuple[float, ...]:
        """Position and orientation of the camera."""
        return (*self.view.camera.position_m, *self.view.camera.orientation_xyzw)

    @property
    def drawn(self) -> Selection:
        """The selection without what is outside the frustum, by ascending node."""
        ids, inside = self.selection.ids, self.view.state.inside
        order = np.argsort(ids)
        order = order[inside[ids[order]]]
        return replace(self.selection, ids=ids[order], detail=self.selection.detail[order])


class Notes(Watched):
    """A policy whose frames are kept."""

    def __init__(self, policy: Policy) -> None:
        super().__init__(policy)
        self.frames: list[Frame] = []
        # A replay computes the best that any selection could have been beside each frame of an
        # oracle: half of the time of all its promises, none of which looks at it.  So the replay
        # does not hear of the oracle, which is told the truth here.
        self._foresees = policy.capabilities.future and isinstance(policy, Clairvoyant)
        type(self).capabilities = replace(policy.capabilities, future=False)

    def show(self, view: View) -> View:
        """Return what the policy is to see instead of a view: here the view itself."""
        return view

    def select(self, view: View) -> Selection:
        """Show the policy a view, and note what it makes of it."""
        seen = self.show(view)
        if self._foresees and view.scene.costs is not None:
            self.foresee(Truth(view.scene.costs, 1.0))  # without noise, as all examples are
        selection = super().select(seen)
        if isinstance(selection, Selection):  # pyright: ignore[reportUnnecessaryIsInstance] - a user's policy may return anything
            state, resident = seen.state, seen.state.residency
            kept = replace(
                state,
                inside=state.inside.copy(),
                residency=None if resident is None else resident.copy(),
            )
            most = len(view.scene)
            ids, detail = (_copied(array, most) for array in (selection.ids, selection.detail))
            copied = replace(selection, ids=ids, detail=detail)
            self.frames.append(Frame(View(kept, seen.ids, seen.xyz_m), copied))
        return selection


def _copied(array: Any, most: int) -> Any:
    """Return a copy of an array, or what is none or too long, which the simulator refuses."""
    return array.copy() if type(array) is np.ndarray and array.size <= most else array


Kind = TypeVar("Kind", bound=Notes)


@dataclass(frozen=True, slots=True, eq=False)
class Played(Generic[Kind]):
    """A replay of an example: its log, and what was noted of the policy."""

    log: FrameLog
    notes: Kind

    @property
    def frames(self) -> list[Frame]:
        """Return the frames as the policy met them."""
        return self.notes.frames

    def last_change(self) -> int:
        """Return the last frame in which the camera stood elsewhere than in the one before.

        Or in which other nodes were in memory: what arrives from the disk is a change too.
        """
        for at in range(len(self.frames) - 1, 0, -1):
            now, before = self.frames[at], self.frames[at - 1]
            resident = now.view.state.residency, before.view.state.residency
            if now.pose != before.pose or not _same_memory(*resident):
                return at
        return 0


def _same_memory(one: BoolArray | None, other: BoolArray | None) -> bool:
    return one is None or other is None or bool((one == other).all())


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """A world without noise, a budget and a number of frames."""

    scene: Scene
    trace: CameraTrace
    hardware: HardwareProfile
    budget_ms: float
    frames: int

    def __repr__(self) -> str:
        objects = "object" if len(self.scene) == 1 else "objects"
        frames = "frame" if self.frames == 1 else "frames"
        return (
            f"{len(self.scene)} {objects}, {self.frames} {frames}, budget {self.budget_ms:.4g} ms"
        )

    def play(self, policy: Policy, kind: type[Kind] = Notes) -> Played[Kind]:
        """Replay the example under a policy, of which notes are taken.

        Raises `PolicyError` if the policy breaks its contract.
        """
        notes = watch(policy, kind)
        options = ReplayOptions(budget_ms=self.budget_ms, frames=self.frames)
        name = type(policy).__name__
        log = replay(notes, self.scene, self.trace, self.hardware, options, name=name)
        return Played(log, notes)


@lru_cache(maxsize=64)
def play_fresh(factory: Factory, example: Example) -> Played[Notes]:
    """Replay an example under a new policy, or return what an earlier promise saw of it."""
    return example.play(factory())
