"""What a policy sees of a frame that several cameras look at."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from ..base.arrays import BoolArray, FloatArray
from ..models.machine.cost_terms.term import Pass
from ..models.scene.nodes import per_node
from .view import FrameState, View


class RigView(View):
    """A view of what any of several cameras sees; one selection serves them all.

    Each node is judged where it looks worst: its distance is that of the nearest of the cameras
    that see it, and so its projected error the largest, as all have one lens.  What it covers is
    summed over them.  What none sees is taken as if all did: it is never drawn.  `camera` and
    `xyz_m` are the head's between two eyes, and the first player's.
    """

    @cached_property
    def by_camera(self) -> tuple[View, ...]:
        """The same nodes as each camera sees them alone."""
        points_m = self.state.centers_m.take(self.nodes.at, axis=1)
        return tuple(
            View(state, self.ids, state.camera.to_camera(points_m), self.nodes)
            for state in _states(self.state)
        )

    @property
    def viewport_px(self) -> float:
        """Pixels of all cameras' viewports."""
        return float(len(self.by_camera) * self.camera.viewport_px)

    @property
    def passes(self) -> tuple[Pass, ...]:
        """What each camera draws, and where it sees it."""
        return tuple(map(Pass, self.seen, self.by_camera))

    @property
    def areas_px(self) -> tuple[FloatArray, ...]:
        """Projected area of each bounding sphere in each camera's picture, (m,) each."""
        areas = (eye.area_px for eye in self.by_camera)
        return tuple(area * seen for area, seen in zip(areas, self.seen, strict=True))

    @per_node
    def seen(self) -> BoolArray:
        """Which camera sees which node, (C, m); all do where none does."""
        rig = self.state.rig
        assert rig is not None, "a view of several cameras is of a rig"
        inside = rig.inside.take(self.nodes.at, axis=1)
        return inside | ~inside.any(axis=0)

    @per_node
    def distance_m(self) -> FloatArray:
        """Distance from the nearest camera that sees it to each centre, (m,)."""
        return self._least([eye.distance_m for eye in self.by_camera])

    @per_node
    def area_px(self) -> FloatArray:
        """Projected area of each bounding sphere, summed over the cameras that see it, (m,)."""
        return self._sum([eye.area_px for eye in self.by_camera])

    @per_node
    def inside_share(self) -> FloatArray:
        """Shares of each sphere within the pictures, summed over these, (m,)."""
        return self._sum([eye.inside_share for eye in self.by_camera])

    @per_node
    def covered_px(self) -> FloatArray:
        """Pixels that each node should cover in all pictures, (m,)."""
        return self._sum([eye.covered_px for eye in self.by_camera])

    @per_node
    def eccentricity_deg(self) -> FloatArray:
        """Least angle between a view axis and each centre, over the cameras that see it, (m,)."""
        return self._least([eye.eccentricity_deg for eye in self.by_camera])

    @per_node
    def speed_deg_s(self) -> FloatArray:
        """Apparent angular speed of each centre where it is slowest, (m,)."""
        return self._least([eye.speed_deg_s for eye in self.by_camera])

    def _least(self, each: Sequence[FloatArray]) -> FloatArray:
        return np.where(self.seen, each, np.inf).min(axis=0)

    def _sum(self, each: Sequence[FloatArray]) -> FloatArray:
        return np.where(self.seen, each, 0.0).sum(axis=0)


def _states(state: FrameState) -> list[FrameState]:
    """Return what the view of each camera alone is computed from."""
    rig = state.rig
    assert rig is not None, "a view of several cameras is of a rig"
    before = rig.previous or (None,) * len(rig.cameras)
    return [
        replace(
            state,
            camera=camera,
            inside=inside,
            previous_camera=previous,
            last_placed=None,
            rig=None,
        )
        for camera, previous, inside in zip(rig.cameras, before, rig.inside, strict=True)
    ]
