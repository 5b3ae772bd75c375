"""``cluster-cut``: draw where the own error is within a tolerance and the parent's is not."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection, Work
from ..shared.levels.error_ladder import ErrorLadder
from ..shared.ranges import AtLeastOne, Finite, NotNegative, Share, check_parameters
from ..shared.times.reports import Reports, steer
from ..shared.trees.hierarchy import Hierarchy
from ..view import View


@dataclass
class ClusterCut:
    """Idea: every node decides for itself, and a tolerance for all is steered by measured time.

    A node is drawn where its own projected error is within the tolerance and its parent's is not,
    or where it is above and there is nothing finer.  That is a front only if errors never grow
    downwards, which is enforced: a node's error is at least that of each child.  The tolerance is
    multiplied by ``(time / target)^gain`` when a frame's time arrives, within a dead band, a limit
    to its rate and two bounds.  In a flat scene an object takes its coarsest level (or knot) within
    the tolerance.

    Uses: error and distance of nodes, work times of completed frames.

    Parameters: as below.

    Cost per frame: O(N), one visit and one comparison for each node, all independent.

    Reference: cluster hierarchies as in Nanite and meshoptimizer (facts of their documentation:
    monotone error, one pixel); Nanite steers its pixels per edge by a time budget only with dynamic
    resolution, whose rule ``sqrt(target / time)`` is taken here.
    """

    tolerance_px: Finite = 1.0  # Nanite: pixels per edge; meshoptimizer: error of one pixel
    max_px: Finite = 64.0  # ours; Nanite's floor of 30 % resolution would be 3.3 px
    target: Share = 0.9  # Unreal's headroom of 10 %
    gain: NotNegative = 0.5  # Unreal's square root
    dead_band: NotNegative = 0.05  # ours
    rate_limit: AtLeastOne = 1.1  # ours: at most 10 % a frame

    rising: ClassVar[tuple[str, ...]] = ("tolerance_px", "max_px")
    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True, hierarchy=True)
    # Not the target: with the tolerance where it is nothing finer than a pixel would ever be drawn,
    # and steering about a low target swings where a higher tolerance rests.
    knob: ClassVar[Knob] = Knob("tolerance_px", 0.05, 64.0, finer="lower")

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start from the tolerance."""
        check_parameters(self, "cluster-cut")
        self._chooser = ErrorLadder(scene) if scene.flat else Hierarchy(scene)
        self._target_ms = self.target * budget_ms
        self._reports = Reports()
        self._steered_px = self.tolerance_px

    def select(self, view: View) -> Selection:
        """Steer the tolerance, then return levels or a front within it."""
        time_ms = self._reports.newest_ms(view, view.completed.work_ms, self._target_ms)
        ratio = time_ms / self._target_ms
        steered_px = steer(self._steered_px, ratio, self.gain, self.dead_band, self.rate_limit)
        self._steered_px = min(max(steered_px, self.tolerance_px), self.max_px)
        tree = self._chooser
        if isinstance(tree, ErrorLadder):
            return tree.select(view, self._steered_px, 0.0)
        everything = view.at(np.arange(len(tree.scene), dtype=np.int32))
        error_px = tree.error_m * view.camera.focal_px / everything.nearest_m
        above = tree.raise_to_children(error_px) > self._steered_px
        ids, detail = tree.front(view, tree.close(view, above))
        return Selection(ids, detail, Work(len(tree.scene), len(tree.scene)))
