"""Plays frames to a policy without the simulator: cull, show, select, look at the selection."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...models.machine.frame_cost import FrameCost
from ...models.scene.benefit import level_accuracy, level_primitives
from ...models.scene.camera import Camera
from ...models.scene.frustum import Culler
from ...models.scene.scene import Scene
from ...models.scene.tree import Tree
from ...policies.frame_times import Completed
from ...policies.protocol import Oracle, Policy, Truth
from ...policies.selection import Selection, find_violation
from ...policies.view import FrameState, View

_Result = TypeVar("_Result")

DELAY = 2
"""Frames until a frame's time is known."""

Timer = Callable[[list[float]], list[float]]
"""What timers report of the frames whose times are due, from their true milliseconds."""


class CheckError(AssertionError):
    """A policy breaks the contract, or what it claims."""


def live(times_ms: list[float]) -> list[float]:
    """Return what a good timer reports: its last digits never stand still."""
    return [ms * (1.0 + 1e-6 * (k % 7)) for k, ms in enumerate(times_ms)]


@dataclass(frozen=True, slots=True)
class Played:
    """What a policy saw of one frame, what it selected, and what of that is drawn, and its time."""

    view: View
    selection: Selection
    drawn: Selection
    gpu_ms: float

    @property
    def primitives(self) -> float:
        """Triangles and splats drawn, times the share of the picture that is rendered."""
        levels = self.view.scene.types.levels
        count = _levelled(self.view, self.drawn, level_primitives(levels)).sum()
        return float(count) * self.drawn.render_scale**2

    @property
    def benefit(self) -> float:
        """Sum of projected area, accuracy and importance over what is drawn."""
        seen = self.view.at(self.drawn.ids)
        accuracy = level_accuracy(self.view.scene.types.levels)
        weight = seen.area_px * self.view.scene.importance[seen.ids]
        return float((weight * _levelled(self.view, self.drawn, accuracy)).sum())


class Player:
    """Plays one frame after another of a scene to a policy, whose selections have to be valid.

    Frames take what the scene's cost model says, without noise.
    """

    def __init__(
        self,
        policy: Policy,
        scene: Scene,
        budget_ms: float,
        *,
        timer: Timer = live,
        step_s: float = 1.0 / 60.0,
        resident: BoolArray | None = None,
    ) -> None:
        self._policy, self._scene = policy, scene
        self._timer, self._step_s, self._resident = timer, step_s, resident
        self._culler = Culler(scene.radius_m)
        self._tree = None if scene.flat else Tree(scene)
        self._centers_m = np.ascontiguousarray(scene.center_m.T)
        self._last_detail = np.full(len(scene), np.nan)
        self._times_ms: list[float] = []
        self._last: Played | None = None
        self._call(lambda: policy.reset(scene, budget_ms))

    def play(self, camera: Camera) -> Played:
        """Play the next frame.

        Raises
        ------
        CheckError
            If the policy raises, or its selection is not valid.
        """
        view = self.show(camera)
        return self.finish(view, self.ask(view))

    def show(self, camera: Camera) -> View:
        """Return what the policy is to see of the next frame."""
        frame = len(self._times_ms)
        reports = np.array(self._timer(self._times_ms[: max(0, frame - DELAY)]), dtype=np.float64)
        times = np.outer(reports, (0.5, 1.0, 1.0, 1.0))
        ids, xyz_m = self._culler.cull(self._centers_m, camera)
        inside = self._culler.inside.copy()  # frames are looked at after later ones
        inside.flags.writeable = False
        last = self._last
        state = FrameState(
            self._scene,
            camera,
            self._centers_m,
            frame,
            round(frame * self._step_s * 1e9),
            self._last_detail,
            Completed(times, len(times)),
            inside,
            None if last is None else last.selection,
            None if last is None else last.view.camera,
            self._step_s if frame else 0.0,
            self._resident,
        )
        view = View(state, ids, xyz_m)
        if self._tree is None:
            return view
        roots = self._scene.roots
        return view.at(roots[inside[roots]])

    def ask(self, view: View) -> Selection:
        """Return the policy's selection."""
        policy, costs = self._policy, self._scene.costs
        assert costs is not None, "stages have costs"
        if policy.capabilities.future and isinstance(policy, Oracle):
            policy.foresee(Truth(costs, 1.0))
        selection = self._call(lambda: policy.select(view))
        self._require(find_violation(selection, view.ids, self._scene, self._tree))
        return selection

    def finish(self, view: View, selection: Selection) -> Played:
        """Draw a selection."""
        inside = view.inside if selection.ids is view.ids else view.state.inside[selection.ids]
        drawn = replace(selection, ids=selection.ids[inside], detail=selection.detail[inside])
        if self._resident is not None and not self._resident[drawn.ids].all():
            self._require("ids: expected nodes in memory only")
        self._last_detail[drawn.ids] = drawn.detail
        self._last = Played(view, selection, drawn, frame_ms(view, drawn))
        self._times_ms.append(self._last.gpu_ms)
        return self._last

    def _require(self, violation: str | None) -> None:
        if violation is not None:
            raise CheckError(f"{self._scene.name}, frame {len(self._times_ms)}: {violation}")

    def _call(self, call: Callable[[], _Result]) -> _Result:
        try:
            return call()
        except Exception as error:
            self._require(f"{type(error).__name__}: {error}")
            raise


def frame_ms(view: View, drawn: Selection) -> float:
    """Return the time of a frame by the scene's cost model."""
    costs, levels = view.scene.costs, view.scene.types.levels
    assert costs is not None, "stages have costs"
    seen = view.at(drawn.ids)
    row, fraction = levels.position(seen.type_index, drawn.detail)
    frame = FrameCost(costs, levels).frame
    share = drawn.render_scale**2
    return frame(row, seen, view.camera.viewport_px, fraction=fraction, pixel_share=share).gpu_ms


def coarsest(view: View) -> Selection:
    """Return the least that a view can be drawn with: roots, or what an empty root stands above."""
    scene = view.scene
    levels = scene.types.levels
    empty = level_primitives(levels)[levels.start[:-1]][scene.type_index] == 0.0
    empty &= np.diff(scene.child_start) > 0
    front = view.ids
    while empty[front].any():
        below = [scene.children(node) for node in front[empty[front]].tolist()]
        front = np.concatenate((front[~empty[front]], *below)).astype(np.int32)
    front = front[view.state.inside[front]]
    kind = scene.type_index[front]
    coarse = np.where(
        levels.continuous[kind], levels.min_resolution[kind], levels.level_count[kind] - 1.0
    )
    return Selection(front, coarse)


def _levelled(view: View, drawn: Selection, column: FloatArray) -> FloatArray:
    """Return the values of a per-level column for what is drawn."""
    levels = view.scene.types.levels
    row, fraction = levels.position(view.scene.type_index[drawn.ids], drawn.detail)
    return levels.interpolate(column, row, fraction)
