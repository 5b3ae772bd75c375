"""``mason-blake``: hierarchical increments and decrements within a predicted cost."""

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
from ..shared.ranges import Aim, check_parameters
from ..shared.trees.hierarchy import Hierarchy, NodeCosts, gains
from ..solvers.tree_hull import TreeIncrements, next_above, take_part, tree_increments
from ..view import View


@dataclass
class MasonBlake:
    """Idea: solve the multiple-choice knapsack on a tree, starting from the last frame's front.

    An increment replaces a drawn node by finer ones, and a decrement undoes an increment.  While
    the front costs more than the budget, the increment with the least benefit per cost is undone.
    Then the increment with the most benefit per cost is taken, again and again, undoing worse ones
    that take up its room, until one does not fit and none worse is left.  Increments are edges of
    the upper hull: refinements that pay only together with deeper ones are one increment.  Of the
    increment that does not fit, the part that does is taken.  The best single refinement (with
    those above it) is drawn instead if it brings more.

    Where refinements pay less and less down the tree, this brings at least half of the optimum's
    gain over the roots: the increments taken and the first that does not fit exceed the relaxed
    optimum.  Where a refinement pays only through several deeper ones, no order by slope has such a
    bound.  Roots in view are always covered, over budget if need be.

    Uses: the scene's cost model, projected area and importance of the leaves in view.

    Parameters: `aim`.

    Cost per frame: O(n log n) for n nodes in view, and a step for each increment that changed.

    Reference: Mason and Blake, "Automatic hierarchical level of detail optimization in computer
    animation", Eurographics 1997, and the correction announced for it (UCT CS99-04-00); neither
    text was at hand, so that the algorithm is derived from the hull argument.
    """

    aim: Aim = 1.0  # share of the budget that the predicted time may take

    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, hierarchy=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        return Claims(budget=self.aim <= 1.0, settles_frames=1)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters, tabulate the hierarchy and start from the roots."""
        check_parameters(self, "mason-blake")
        self._costs = NodeCosts(scene, require_costs(scene, "mason-blake"))
        self._hierarchy = Hierarchy(scene)
        self._budget_ms = self.aim * budget_ms
        self._refined = np.zeros(len(scene), dtype=np.bool_)

    def select(self, view: View) -> Selection:
        """Return the front that increments and decrements lead to."""
        tree = self._hierarchy
        offers = gains(tree, self._costs, view)
        fixed_ms = self._costs.fixed_ms(view)
        base_ms = fixed_ms + float(offers.cost_ms[tree.coarsest(view)].sum())
        more_ms, more = tree.fold_empty(offers.more_ms), tree.fold_empty(offers.more_benefit)
        path_ms, path = _down_paths(tree, more_ms), _down_paths(tree, more)
        fits = path_ms <= self._budget_ms - base_ms
        item = tree.inner & ~tree.empty & view.state.inside & (fits | (more_ms <= 0.0))
        item = tree.close(view, item) & ~tree.empty
        increments = tree_increments(tree, more_ms, more, item)
        taken, steps = self._exchange(increments, base_ms)
        refined = item & taken[increments.owner] if len(taken) else item
        gain = float(increments.benefit[taken].sum())
        misfit = np.flatnonzero(~taken & (increments.slope > 0.0))[:1]
        members = np.flatnonzero(item & (increments.owner == misfit)) if len(misfit) else misfit
        if len(members) > 1:
            left = self._budget_ms - base_ms - float(increments.cost[taken].sum())
            part, more_gain = take_part(next_above(tree, item), members, more_ms, more, left)
            refined[part] = True
            gain += more_gain
        single = int(np.where(item & fits, path, -np.inf).argmax())
        if item[single] and path[single] > gain:
            refined = _path_to(tree, single)
        self._refined = tree.close(view, refined)
        ids, detail = tree.front(view, self._refined)
        predicted_ms = fixed_ms + float(offers.cost_ms[ids].sum())
        k = len(increments.cost)
        work = Work(offers.visited, k * k.bit_length(), steps)
        return Selection(ids, detail, work, predicted_ms=predicted_ms)

    def _exchange(self, increments: TreeIncrements, base_ms: float) -> tuple[BoolArray, int]:
        """Return which increments are taken, and in how many steps from the last frame's."""
        k = len(increments.cost)
        owner = increments.owner
        taken = np.ones(k, dtype=np.bool_)
        taken[owner[(owner >= 0) & ~self._refined]] = False
        taken |= np.isinf(increments.slope) & (increments.slope > 0)
        free = int(np.count_nonzero(np.isposinf(increments.slope)))
        price, state = increments.cost.tolist(), taken.tolist()
        left = self._budget_ms - base_ms - float(increments.cost[taken].sum())
        steps: int = 0
        best: int = free
        last: int = k - 1
        end = int(np.count_nonzero(increments.slope > 0.0))
        while True:
            while best < k and state[best]:
                best += 1
            while last >= free and not state[last]:
                last -= 1
            worth = best < end
            if worth and price[best] <= left:
                state[best], left = True, left - price[best]
                last = max(last, best)
            elif last >= free and (left < 0.0 or last > best or last >= end):
                state[last], left = False, left + price[last]
                best = min(best, last)
            else:
                return np.array(state, dtype=np.bool_), steps
            steps += 1


def _down_paths(tree: Hierarchy, values: FloatArray) -> FloatArray:
    """Return each node's sum of values over itself and its ancestors."""
    total = values.copy()
    for layer in tree.layers[1:]:
        total[layer] += total[tree.scene.parent[layer]]
    return total


def _path_to(tree: Hierarchy, node: int) -> BoolArray:
    path = np.zeros(len(tree.scene), dtype=np.bool_)
    while node >= 0:
        path[node] = True
        node = int(tree.scene.parent[node])
    return path
