"""``maciel``: refinement by benefit over cost, each switch held back by a counter."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import BoolArray, FloatArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.knobs import AIM
from ..shared.levels.choices import require_costs
from ..shared.ranges import Aim, Count, check_parameters
from ..shared.trees.best_first import refine_best_first
from ..shared.trees.hierarchy import Hierarchy, NodeCosts, gains
from ..view import View


@dataclass
class Maciel:
    """Idea: refine the node whose children have most benefit for their cost, but not at once.

    A pass from the leaves up sums each node's cost and benefit, and those of its children.  A pass
    from the roots down refines, while the sum fits the budget, the drawn node whose children have
    the most benefit per cost.  A node is not refined before it has been chosen in more than
    `threshold` frames in a row, however urgent the switch is; it is coarsened at once.  A
    refinement that saves time does not wait.

    Uses: the scene's cost model, projected area and importance of the leaves in view.

    Parameters: `threshold`, `aim`.

    Cost per frame: O(n) for n nodes in view, and O(log n) for each node refined.

    Reference: Maciel and Shirley, "Visual navigation of large environments using textured
    clusters", I3D 1995, as the HLOD thesis describes it (sections 2.3 and 4.2); the text itself was
    not at hand.  That coarsening is not held back is our reading of "from parent to children".
    """

    threshold: Count = 8  # ours: frames; the thesis says only that it is fixed
    aim: Aim = 1.0  # share of the budget that the predicted time may take

    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, hierarchy=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        return Claims(budget=self.aim <= 1.0, settles_frames=self.threshold + 2)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters, tabulate the hierarchy and start from the roots."""
        check_parameters(self, "maciel")
        self._costs = NodeCosts(scene, require_costs(scene, "maciel"))
        self._hierarchy = Hierarchy(scene)
        self._budget_ms = self.aim * budget_ms
        self._refined = np.zeros(len(scene), dtype=np.bool_)
        self._wished = np.zeros(len(scene), dtype=np.int32)

    def select(self, view: View) -> Selection:
        """Return the front that is wished for, less what is held back."""
        tree = self._hierarchy
        gain = gains(tree, self._costs, view)
        fixed_ms = self._costs.fixed_ms(view)
        base_ms = fixed_ms + float(gain.cost_ms[tree.coarsest(view)].sum())
        more_ms = tree.fold_empty(gain.more_ms)
        # Children that cost nothing are all outside the frustum.
        key = np.full(len(more_ms), np.inf)
        costs = gain.children_ms > 0.0
        np.divide(gain.children_benefit, gain.children_ms, out=key, where=costs)
        wish, looked = refine_best_first(tree, view, key, more_ms, self._budget_ms - base_ms)
        refined = tree.close(view, wish & self._ready(view, wish, more_ms))
        ids, detail = tree.front(view, refined)
        if fixed_ms + float(gain.cost_ms[ids].sum()) > max(self._budget_ms, base_ms):
            # What is held back would have made room for the rest.
            refined = tree.close(view, wish)
            ids, detail = tree.front(view, refined)
        inside = view.state.inside
        self._refined[inside] = refined[inside]
        predicted_ms = fixed_ms + float(gain.cost_ms[ids].sum())
        work = Work(gain.visited, looked * looked.bit_length())
        return Selection(ids, detail, work, predicted_ms=predicted_ms)

    def _ready(self, view: View, wish: BoolArray, more_ms: FloatArray) -> BoolArray:
        """Count the wishes of this frame and return which nodes may be refined."""
        inside = view.state.inside
        new = wish & ~self._refined
        self._wished[inside & ~new] = 0
        self._wished[new] += 1
        return self._refined | (self._wished > self.threshold) | (more_ms <= 0.0)
