"""``erikson``: largest projected error first, within polygons that past frames could afford."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection, Work
from ..shared.knobs import TARGET
from ..shared.ranges import Share, check_parameters
from ..shared.times.reports import Reports
from ..shared.trees.best_first import refine_best_first
from ..shared.trees.hierarchy import Hierarchy
from ..view import View


@dataclass
class Erikson:
    """Idea: refine the node whose error looks largest until the polygons of the frame are used up.

    The polygon budget is what the newest completed frame drew, times the target over the time that
    it took.  Before any frame has completed only the roots are drawn.  Neither costs nor switches
    are weighed, so that the front follows every change of measured time.

    Uses: work times of completed frames, error and distance of nodes.

    Parameters: `target`.

    Cost per frame: O(n) for n nodes in view, and O(log n) for each node refined.

    Reference: Erikson, Manocha and Baxter, "HLODs for faster display of large static and dynamic
    environments", I3D 2001 (mode of target frame rate), as the HLOD thesis describes it (section
    2.3).
    """

    target: Share = 0.9  # share of the budget to aim at; Unreal's headroom

    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, hierarchy=True)
    knob: ClassVar[Knob] = TARGET

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters, tabulate the hierarchy and start with no polygons to spend."""
        check_parameters(self, "erikson")
        self._hierarchy = Hierarchy(scene)
        self._budget_ms = budget_ms
        self._reports = Reports()
        self._drawn: list[float] = []
        self._polygons = 0.0

    def select(self, view: View) -> Selection:
        """Return the front within the polygon budget."""
        tree = self._hierarchy
        target_ms = self.target * self._budget_ms
        frames, times_ms = self._reports.new(view, view.completed.work_ms, target_ms)
        if len(frames) and (drawn := self._drawn[int(frames[-1])]) > 0.0:
            self._polygons = drawn * target_ms / float(times_ms[-1])
        seen = view.at(np.flatnonzero(view.state.inside))
        error_px, polygons = np.zeros(len(tree.scene)), np.zeros(len(tree.scene))
        error_px[seen.ids] = tree.error_m[seen.ids] * view.camera.focal_px / seen.nearest_m
        polygons[seen.ids] = tree.tree.primitives[seen.ids]
        room = self._polygons - float(polygons[tree.coarsest(view)].sum())
        # What refining each node adds.
        own = np.where(tree.scene.additive | ~tree.inner, 0.0, polygons)
        more = tree.fold_empty(tree.sum_children(polygons) - own)
        refined, looked = refine_best_first(tree, view, error_px, more, room)
        ids, detail = tree.front(view, tree.close(view, refined))
        self._drawn.append(float(polygons[ids].sum()))
        work = Work(len(seen.ids), looked * looked.bit_length())
        return Selection(ids, detail, work)
