"""``lodmanager``: levels of continuous models that objects of one type lend each other."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...models.scene.levels import LevelTable
from ...models.scene.scene import Scene
from ..frame_times import Completed
from ..protocol import Capabilities
from ..selection import Selection, Work
from ..shared.level_pools import SharedLevels
from ..shared.ranges import (
    AtLeastOne,
    NotNegative,
    Positive,
    PositiveInt,
    Share,
    UpToOne,
    check_parameters,
)
from ..shared.reports import Reports
from ..thresholds.static_distance import distance_range
from ..view import View

_NONE = np.empty(0, dtype=np.int32)


@dataclass
class LodManager:
    """Idea: extract as few levels as possible: objects that want similar levels share one.

    An object wants the factor ``clamp(1 - (d - near) / (far - near), 0, 1)^e``.  Factor 0 is the
    type's coarsest resolution and 1 its full one, linear between.  Each type has `slots` slots, and
    two factors are similar if they fall into the same slot, ``trunc(lod^spacing · slots)``, factor
    1 into the last.  An object whose level is not similar to the wanted one borrows: it draws the
    level of the wanted slot's holder, and gives up a slot that it held itself.  Where the slot has
    no holder, the object extracts its own level and holds the slot (algorithm 4.1).  Discrete
    levels are ready to draw: their slots are the levels, and nothing is extracted or shared.

    Objects are visited by falling difference between wanted and shown factor.  Those without a
    level come first, from the median of their slot outwards, so that a shared level is about as
    often too fine as too coarse (the paper visits in the order of its array, so that numbering
    would matter).  With `active` only so many of the objects that need another level are visited in
    a frame, and the others wait; objects without a level never wait.  Objects outside the frustum
    then count with the factor `outside`, and may borrow before they are seen.  They extract
    nothing, as what is not drawn has no index set here.  An index set whose owner has left the view
    stays and may be borrowed.

    Each completed frame outside the dead band multiplies the exponent e by `gain` if it was too
    slow, and divides it if it was fast enough (``lod^n`` and ``lod^(1/n)``, which the text names
    the other way round).  With ``limit=gain`` the exponent is one of `gain`, 1 and 1 / `gain`: the
    printed rule, but for the 1 in between.

    Uses: distance to the bounding sphere's centre, work times of completed frames.

    Parameters: as below; `sharing` off is the paper's baseline, where every object whose level is
    not similar to the wanted one extracts its own.

    Cost per frame: O(n), one visit an object, and the sorting of those that need another level.
    Extracted and borrowed levels are charged by the simulator.

    Reference: Gumbau, Ripolles and Chover, "LODManager: a framework for rendering multiresolution
    models in real-time applications", sections 4.1 to 4.3.
    """

    slots: PositiveInt = 32  # ours: N_T is left to the user; steps of 3 %
    spacing: Positive = 1.0  # linear; above 1 slots are finer near the eye, as in section 4.3
    sharing: bool = True  # the paper; off is its baseline
    active: PositiveInt | None = None  # N_a, left to the user; None: no list, all in the frustum
    outside: UpToOne = 0.25  # ours: the paper's penalty is not printed
    gain: AtLeastOne = 1.02  # ours: n; the paper's curves have 2, too strong for every frame
    limit: float = 4.0  # ours: e stays within 1 / limit and limit
    target: Share = 0.9  # as feedback
    dead_band: NotNegative = 0.05  # as feedback
    near_m: float | None = None  # None: 1 % of the scene's extent
    far_m: float | None = None  # None: 50 % of the scene's extent

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start with empty slots and an exponent of 1."""
        check_parameters(self, "lodmanager", "gain", "limit")
        self._range_m = distance_range("lodmanager", scene, self.near_m, self.far_m)
        self._target_ms = self.target * budget_ms
        self._exponent = 1.0
        self._reports = Reports()
        soft = scene.types.levels.continuous
        self._slots = np.where(soft, self.slots, scene.types.levels.level_count)
        self._first_slot = np.cumsum(self._slots) - self._slots
        self._shares = soft & self.sharing
        self._levels = SharedLevels(len(scene), int(self._slots.sum()))
        self._all = np.arange(len(scene), dtype=np.int32)

    def select(self, view: View) -> Selection:
        """Borrow or extract where the level shown is not similar to the one wanted."""
        self._steer(view.completed)
        seen = view if self.active is None else view.at(self._all)
        kind, lod = seen.type_index, self._wanted_lod(seen)
        place = lod if self.spacing == 1.0 else lod**self.spacing
        step = np.minimum(np.trunc(place * self._slots[kind]), self._slots[kind] - 1)
        slot = self._first_slot[kind] + step.astype(np.int32)
        order, differing = self._order(seen, lod, slot)
        self._update(seen, order, lod[order], slot[order])
        source = self._levels.source[view.ids]
        # What an engine does: a look at each object, a sort, and a look at each slot wanted.
        compared = len(order) + differing * differing.bit_length()
        work = Work(objects_visited=len(seen), comparisons=compared)
        detail = self._levels.detail[source]
        return Selection(view.ids, detail, work, source if self._shares.any() else None)

    def _steer(self, completed: Completed) -> None:
        ratio = self._reports.newest_ms(completed.work_ms, self._target_ms) / self._target_ms
        if math.isnan(ratio) or abs(ratio - 1.0) <= self.dead_band:
            return
        step = self.gain if ratio > 1.0 else 1.0 / self.gain
        self._exponent = min(max(self._exponent * step, 1.0 / self.limit), self.limit)

    def _wanted_lod(self, seen: View) -> FloatArray:
        near_m, far_m = self._range_m
        lod = 1.0 - (seen.distance_m - near_m) / (far_m - near_m)
        np.clip(lod, 0.0, 1.0, out=lod)
        return lod if self._exponent == 1.0 else lod**self._exponent

    def _order(self, seen: View, lod: FloatArray, slot: IntArray) -> tuple[IntArray, int]:
        """Return positions in the order of visits, and how many need another level."""
        shown, shown_lod = self._levels.shown(seen.ids)
        differs = shown != slot
        gap = np.where(differs, np.abs(lod - shown_lod), 0.0)
        new = shown < 0
        if self.active is None:
            at, limit = np.arange(len(seen)), len(seen)
        else:
            inside = seen.inside
            gap[~inside] *= self.outside
            new &= inside
            lends = self._shares[seen.type_index]
            at = np.flatnonzero(differs & (inside | (lends & (gap > 0.0))))
            limit = max(self.active, int(np.count_nonzero(new)))
        count = int(np.count_nonzero(differs[at]))
        if not count:
            return at[:0], 0
        gap[new] = np.inf
        off_median = np.abs(lod - _median_of_slot(lod, slot))
        order = np.lexsort((seen.distance_m[at], off_median[at], -gap[at]))
        return at[order[:limit]], count

    def _update(self, seen: View, order: IntArray, lod: FloatArray, slot: IntArray) -> None:
        """Let the objects at these positions have their turns."""
        levels, node, kind = self._levels, seen.ids[order], seen.type_index[order]
        detail = self._detail(seen.scene.types.levels, kind, lod, slot)
        inside, shares = seen.inside[order], self._shares[kind]
        shown, _ = levels.shown(node)
        own = np.flatnonzero(~shares & inside & (shown != slot))
        levels.extract(node[own], slot[own], lod[own], detail[own])
        at = np.flatnonzero(shares)
        levels.visit(node[at], slot[at], lod[at], detail[at], inside[at])

    def _detail(
        self, table: LevelTable, kind: IntArray, lod: FloatArray, slot: IntArray
    ) -> FloatArray:
        """Return resolutions of continuous types, and levels of discrete ones by their slots."""
        low = table.min_resolution[kind]
        coarseness = table.level_count[kind] - 1 - (slot - self._first_slot[kind])
        return np.where(
            table.continuous[kind], np.minimum(low + lod * (1.0 - low), 1.0), coarseness
        )


def _median_of_slot(lod: FloatArray, slot: IntArray) -> FloatArray:
    """Return for each object the lower median of the factors wanted in its slot, (m,)."""
    order = np.lexsort((lod, slot))
    first = np.searchsorted(slot[order], slot, side="left")
    last = np.searchsorted(slot[order], slot, side="right") - 1
    return lod[order[(first + last) // 2]]
