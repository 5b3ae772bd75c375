"""``static-distance``: level from distance alone."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.kept import Kept
from ..shared.levels.discretise import detail_of_level, level_of_detail
from ..shared.levels.distance_range import distance_range
from ..shared.ranges import BelowOne, Finite, check_parameters
from ..view import View


@dataclass
class StaticDistance:
    """Idea: ``lod = clamp(1 - (d - near) / (far - near), 0, 1)``, spread evenly over the levels.

    A node returns to a finer level only when it is nearer than that level's threshold by the
    hysteresis share, as in three.js: up at 50 m, back at 45 m with 0.1.  Levels of continuous
    types are their knots.

    Uses: distance to the bounding sphere's centre.

    Parameters: `near_m` (finest level up to here), `far_m` (coarsest from here), `hysteresis`,
    `scale` (of both distances).

    Cost per frame: O(n), one visit an object.

    Reference: Gumbau et al., LODManager, section 4.2 (printed without the ``1 -``); hysteresis as
    in three.js's LOD object, default 0 there.
    """

    near_m: float | None = None  # None: 4 radii of each object
    far_m: float | None = None  # None: 80 radii of each object
    hysteresis: BelowOne = 0.0  # share of a threshold by which to return late; three.js: 0
    scale: Finite = 1.0  # ours: both distances together, as engines scale them by view distance

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = Knob("scale", 0.02, 50.0)

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        return Claims(settles_frames=0, hysteresis=self.hysteresis > 0.0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Resolve distances that depend on the scene."""
        check_parameters(self, "static-distance")
        near_m, far_m = distance_range("static-distance", scene, self.near_m, self.far_m)
        self._near_m = self.scale * near_m
        self._per_m = (scene.level_count) / (self.scale * (far_m - near_m))
        self._discrete = not scene.types.levels.continuous.any()
        self._of_node = Kept(self._gather)

    def _gather(self, view: View) -> tuple[FloatArray, FloatArray]:
        """Return where the finest level of each candidate ends, and its levels per metre, (m,)."""
        at = view.nodes.at
        return self._near_m.take(at), self._per_m.take(at)

    def select(self, view: View) -> Selection:
        """Return a level for every candidate."""
        nodes = view.nodes
        near_m, per_m = self._of_node.of(view)
        level = view.distance_m - near_m
        level *= per_m
        np.floor(level, out=level)
        np.maximum(level, 0.0, out=level)
        np.minimum(level, nodes.coarsest_level, out=level)
        if self.hysteresis:
            self._hold(level, view)
        if self._discrete:
            return Selection(view.ids, level, Work(objects_visited=len(view.ids)))
        detail = detail_of_level(view.scene.types.levels, nodes.type_index, level)
        return Selection(view.ids, detail, Work(objects_visited=len(view.ids)))

    def _hold(self, level: FloatArray, view: View) -> None:
        """Keep the previous level where a node is only slightly nearer than its threshold."""
        table = view.scene.types.levels
        before = level_of_detail(table, view.type_index, view.previous_detail)
        near_m, per_m = self._of_node.of(view)
        threshold_m = near_m + before / per_m
        near = view.distance_m >= threshold_m * (1.0 - self.hysteresis)
        # three.js lowers the threshold of the level that is visible, and not those before it.  A
        # comparison with NaN, never drawn before, is false.
        hold = (level == before - 1.0) & near
        level[hold] = before[hold]
