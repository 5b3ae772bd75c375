"""``hlod-hysteresis``: time slices down the tree, and counters that switch by urgency."""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...base.predictors import LEVEL_PREDICTORS
from ...models.scene.rotation import rotate
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.knobs import TARGET
from ..shared.ranges import (
    AtLeastOne,
    BelowOne,
    Fraction,
    NotNegative,
    Share,
    UpToOne,
    check_parameters,
)
from ..shared.times.time_loops import TimeLoops
from ..shared.times.time_slices import divide_time
from ..shared.trees.hierarchy import Hierarchy
from ..shared.trees.priority_list import PriorityList
from ..view import View

_TEXTURED = LEVEL_PREDICTORS.index("textured_triangles")
_PLENTY = 2.0
"""Slice over need at which a node has enough, so that its urgency is 1: from the lowest count it is
switched in four frames."""


@dataclass
class HlodHysteresis:
    """Idea: siblings share their parent's time, and switch when their shares stay out of balance.

    In each frame, from the roots down, the visible siblings of a family share their parent's time
    slice in proportion to their priority,
    ``sqrt(triangles · surface) · (1 + c_vis · visibility) · (1 + c_fore · facing) / (cost ·
    distance²)``.  Each adds
    ``(slice - needed) / needed``, its urgency, to a counter that stays within ``±limit``.  If
    ``Σ trunc(counter / switch)`` over the visible siblings is at least 0 and they are all in
    memory, they are drawn, or refined further, in place of their parent; otherwise the parent is
    drawn.  Roots are always drawn or refined.  So a family far out of balance switches within a few
    frames, and one that nearly fits takes long or never switches.

    Two loops learn from completed frames: the time that a unit of cost takes, and the time that the
    roots share.  The second rises while nodes are refused although time is left, and falls while
    frames take too long.

    What a node gets beyond twice the need of all below it in view goes to its siblings.  The thesis
    names that as future work (section 6.6) and leaves it to the second loop, as ``unused=lost``
    does here: slices that near walls cannot use then drive the roots' share up to many times the
    target, and in a fast drive, where far walls with such slices come near, frames take too long.

    The constants are the thesis' (Table 6.1; its 1500 and 4510 are read as 1.5 and 4.51).  Where
    the thesis leaves a choice: counters start at ``-limit``, since from 0 the first frame would
    draw the finest level; the roots share the target less the fixed overhead; visibility falls from
    1 at the frustum's edge to 0 straight behind; distance is at least the radius, and is taken from
    where the camera will be in `lead_s`; facing is the node's mean normal times that of the image
    plane, turned to the eye, so that what faces the picture gains.  Where a scene has no surface
    areas, all of its nodes have their spheres' discs; where it has no normals, facing is 0.  The
    rates of the two loops are ours.  A node that is drawn together with its children takes its own
    need from the slice first and leaves them the rest.

    The loader is asked for all nodes that are visited, by priority, also those of refused families
    and those outside the frustum.

    Uses: triangles, distance, residency, GPU times of completed frames; the cost model, if there is
    one, for the overhead and a first guess of the time of a unit of cost.

    Parameters: as below.

    Cost per frame: O(v) for v nodes visited, which are those drawn, their ancestors and siblings;
    re-sorting the priority list costs a comparison for each place that a node moves.

    Reference: the HLOD thesis on out-of-core rendering with temporal hysteresis, chapters 3 and 4.
    """

    textured: Fraction = 0.127  # Table 6.1, c_textured
    vis: NotNegative = 1.275  # Table 6.1, c_vis
    fore: BelowOne = 0.45  # Table 6.1, c_fore; below 1, so that no priority is negative
    switch: AtLeastOne = 1.5  # Table 6.1, c_hystSwitch
    limit: float = 4.51  # Table 6.1, c_hystLimit
    all_children: bool = False  # section 5.2: wait for children outside the frustum too
    target: Share = 1.0  # share of the budget to aim at; the thesis aims at all of it
    time_rate: UpToOne = 0.2  # ours: how fast v_time follows measurements; 0 switches it off
    share_rate: UpToOne = 0.003  # ours: "gradually"; relative change of shareTime a frame
    margin: UpToOne = 0.1  # ours: "substantially" below or over the target
    lead_s: NotNegative = 0.1  # ours: "slightly adjusted" for the user's velocity
    unused: Literal["lost", "shared"] = "shared"  # section 6.6; the thesis' own loses it

    rising: ClassVar[tuple[str, ...]] = ("switch", "limit")
    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, hierarchy=True, loader=True)
    knob: ClassVar[Knob] = TARGET
    claims: ClassVar[Claims] = Claims(hysteresis=True)

    @property
    def share_ms(self) -> float:
        """Time that the roots share now."""
        return self._loops.share_ms

    @property
    def ms_per_unit(self) -> float:
        """Time of a unit of cost as learnt so far: the thesis' v_time."""
        return self._loops.ms_per_unit

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters, tabulate costs and benefits, and set every counter to `-limit`."""
        check_parameters(self, "hlod-hysteresis")
        self._hierarchy = tree = Hierarchy(scene)
        levels = scene.types.levels
        finest = levels.start[:-1][scene.type_index]
        textured = levels.counts[finest, _TEXTURED]
        plain = np.maximum(tree.tree.primitives - textured, 0.0)
        # Nodes without geometry count as one unit, so that nothing divides by zero.
        self._units = np.maximum(textured * self.textured + plain * (1.0 - self.textured), 1.0)
        surface_m2 = scene.types.surface_m2[scene.type_index] * scene.scale**2
        if not surface_m2[tree.tree.primitives > 0].all():
            # Discs and true areas differ by factors that grow to the roots: never both.
            surface_m2 = np.pi * scene.radius_m**2
        self._static_benefit = np.sqrt(np.maximum(tree.tree.primitives, 1.0) * surface_m2)
        self._normal = rotate(scene.orientation_xyzw, scene.types.normal[scene.type_index])
        self._loops = TimeLoops(
            scene,
            self._units,
            self.target * budget_ms,
            time_rate=self.time_rate,
            share_rate=self.share_rate,
            margin=self.margin,
        )
        self._counter = np.full(len(scene), -self.limit)
        self._list = PriorityList()

    def select(self, view: View) -> Selection:
        """Return the front that the counters lead to, and the priority list as what is wanted."""
        tree, loops = self._hierarchy, self._loops
        loops.learn(view)
        priority = self._priority(view)
        descent = self._descend(view, priority)
        ids, detail = tree.front(view, tree.close(view, descent.refined))
        self._list.update(descent.visited, priority)
        units = float(self._units[ids].sum())
        predicted_ms = loops.expect(units, descent.pending, refused=descent.refused)
        work = Work(int(np.count_nonzero(descent.visited)), self._list.comparisons)
        return Selection(ids, detail, work, predicted_ms=predicted_ms, wanted=self._list.ids)

    def _priority(self, view: View) -> FloatArray:
        """Return the priority of every node, (N,)."""
        everything = view.at(np.arange(len(self._units), dtype=np.int32))
        ahead_m = everything.xyz_m + self._lead_m(view)[:, None]
        distance_m = np.maximum(np.sqrt((ahead_m**2).sum(axis=0)), everything.radius_m)
        camera = view.camera
        edge = np.arctan2(0.5 * np.hypot(camera.width_px, camera.height_px), camera.focal_px)
        reach = np.arcsin(np.clip(everything.radius_m / distance_m, 0.0, 1.0))
        beyond = np.radians(everything.eccentricity_deg) - edge - reach
        visibility = 1.0 - np.clip(beyond / (np.pi - edge), 0.0, 1.0)
        visibility[view.state.inside] = 1.0
        seen = self._static_benefit * (1.0 + self.vis * visibility)
        # The third axis of the camera points forward, against the image plane's normal.
        seen *= 1.0 - self.fore * (self._normal @ camera.axes[2])
        return seen / (self._units * distance_m**2)

    def _lead_m(self, view: View) -> FloatArray:
        """Return by how much nodes will have moved against the camera, in its frame, (3,)."""
        before, step_s = view.state.previous_camera, view.state.step_s
        if before is None or step_s <= 0.0:
            return np.zeros(3)
        moved_m = np.subtract(view.camera.position_m, before.position_m)
        return view.camera.axes @ moved_m * (-self.lead_s / step_s)

    def _descend(self, view: View, priority: FloatArray) -> "_Descent":
        """Count on the way down from the roots."""
        tree, scene = self._hierarchy, self._hierarchy.scene
        n, inside = len(scene), view.state.inside
        needed_ms = self._loops.ms_per_unit * self._units
        waits = tree.waits(view, for_all=self.all_children)
        descent = _Descent(np.zeros(n, dtype=np.bool_), np.zeros(n, dtype=np.bool_))
        descent.visited[tree.layers[0]] = True
        most_ms = self._most_ms(view, needed_ms)
        slice_ms = np.zeros(n)
        one_family = np.zeros(len(view.ids), dtype=np.intp)
        slice_ms[view.ids] = divide_time(
            one_family, np.array([self.share_ms]), priority[view.ids], most_ms[view.ids]
        )
        active = np.zeros(n, dtype=np.bool_)
        active[view.ids] = True
        for layer in tree.layers[1:]:
            family = layer[active[scene.parent[layer]]]
            siblings = family[inside[family]]
            parent = scene.parent[siblings]
            share_ms = slice_ms - np.where(scene.additive, needed_ms, 0.0)
            slice_ms[siblings] = divide_time(
                parent, share_ms, priority[siblings], most_ms[siblings]
            )
            urgency = self._count(siblings, slice_ms, needed_ms)
            above = np.unique(scene.parent[family])
            now = np.bincount(parent, np.trunc(self._counter[siblings] / self.switch), minlength=n)
            later = np.bincount(parent, np.sign(urgency), minlength=n)
            units = np.bincount(parent, self._units[siblings], minlength=n)
            units = units - np.where(scene.additive, 0.0, self._units)
            free = above[~waits[above]]
            descent.pending += float(((later >= 0.0) * units - (now >= 0.0) * units)[free].sum())
            descent.refused = descent.refused or bool((later[free] < 0.0).any())
            descent.visited[family] = True
            descent.refined[above] = (now[above] >= 0.0) & ~waits[above] | tree.empty[above]
            active[siblings] = descent.refined[parent]
        return descent

    def _most_ms(self, view: View, needed_ms: FloatArray) -> FloatArray:
        """Return the largest slice that each node can have, (N,)."""
        if self.unused == "lost":
            return np.full(len(needed_ms), np.inf)
        tree = self._hierarchy
        unit = (tree.tree.leaf | tree.scene.additive) & view.state.inside
        finest_ms = tree.sum_below(np.where(unit, needed_ms, 0.0))
        return _PLENTY * np.maximum(finest_ms, needed_ms)

    def _count(self, nodes: IntArray, slice_ms: FloatArray, needed_ms: FloatArray) -> FloatArray:
        """Add the urgency of nodes to their counters, and return it."""
        urgency = (slice_ms[nodes] - needed_ms[nodes]) / needed_ms[nodes]
        self._counter[nodes] = np.clip(self._counter[nodes] + urgency, -self.limit, self.limit)
        return urgency


@dataclass(slots=True)
class _Descent:
    """What the way down from the roots found.

    Attributes
    ----------
    refined, visited : (N,) bool
    refused : bool
        Whether a family in memory is short of time, and will be as long as slices stay.
    pending : float
        Units of cost that switches under way will add once counters have followed their urgency.
    """

    refined: BoolArray
    visited: BoolArray
    refused: bool = False
    pending: float = 0.0
