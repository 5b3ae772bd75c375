"""``lodmanager``: levels of continuous models that objects of one type lend each other."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...base.errors import InputError
from ...base.nearest_names import unknown_name
from ...models.scene.levels import LevelTable
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities
from ..selection import Selection, Work
from ..shared.kept import Kept
from ..shared.knobs import TARGET
from ..shared.levels.distance_range import distance_range
from ..shared.levels.level_pools import SharedLevels
from ..shared.levels.visit_order import in_order
from ..shared.ranges import (
    AtLeastOne,
    NotNegative,
    Positive,
    PositiveInt,
    Share,
    UpToOne,
    check_parameters,
)
from ..shared.times.reports import Reports
from ..view import View


class _Same(NamedTuple):
    """What is the same of some nodes in every frame.

    Attributes
    ----------
    slots, last : (m,) float64
        How many slots their types have, and the last one.
    first : (m,) int
        Their types' first slots.
    far_m, span_m : (m,) float64
        Distance from which factor 0 is wanted, and how much nearer factor 1 is.
    """

    slots: FloatArray
    last: FloatArray
    first: IntArray
    far_m: FloatArray
    span_m: FloatArray


class _Turns(NamedTuple):
    """Positions in the order of visits, without those whose visit changes nothing.

    Attributes
    ----------
    at : (v,) int
    visits : int
        Objects that have their turn.
    differing : int
        Those that need another level.
    """

    at: IntArray
    visits: int
    differing: int


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
    would matter).

    With `active` a frame looks at the objects of a list, at one slice of all objects, so that each
    is looked at once in `refresh` frames, and at objects in view without a level, which never wait.
    Of those that need another level the `active` that are furthest off have their turn; the list
    is these and, for the places left, those whose level is furthest from the wanted one though
    similar, which are the next to need another.  Whoever is neither waits for his slice.  Objects
    outside the frustum count with the factor `outside`, and may borrow before they are seen.  They
    extract nothing, as what is not drawn has no index set here, and have no place where there is
    nothing to borrow.  Slices take every so many-th object by place.

    An index set whose owner has left the view stays and may be borrowed.

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
    slots_of: str | None = None  # of types that have others, as ogre:64/tree:16
    spacing: Positive = 1.0  # linear; above 1 slots are finer near the eye, as in section 4.3
    sharing: bool = True  # the paper; off is its baseline
    active: PositiveInt | None = None  # N_a, left to the user; None: no list, all in the frustum
    refresh: PositiveInt = 16  # ours: frames in which all objects are looked at, with a list
    outside: UpToOne = 0.25  # ours: the paper's penalty is not printed
    gain: AtLeastOne = 1.02  # ours: n; the paper's curves have 2, too strong for every frame
    limit: float = 4.0  # ours: e stays within 1 / limit and limit
    target: Share = 0.9  # as feedback
    dead_band: NotNegative = 0.05  # as feedback
    near_m: float | None = None  # None: 4 radii of each object
    far_m: float | None = None  # None: 80 radii of each object

    rising: ClassVar[tuple[str, ...]] = ("gain", "limit")
    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = TARGET

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start with empty slots and an exponent of 1."""
        check_parameters(self, "lodmanager")
        near_m, far_m = distance_range("lodmanager", scene, self.near_m, self.far_m)
        self._target_ms = self.target * budget_ms
        self._exponent = 1.0
        self._reports = Reports()
        soft = scene.types.levels.continuous
        wanted = _slots_by_type(scene.types.names, self.slots, self.slots_of or "")
        self._slots = np.where(soft, wanted, scene.types.levels.level_count)
        self._first_slot = np.cumsum(self._slots) - self._slots
        self._shares = soft & self.sharing
        self._any_shares = bool(self._shares.any())
        self._any_soft = bool(soft.any())
        # By node, so that candidates gather without their types between.
        slots = self._slots[scene.type_index]
        self._of_node = _Same(
            slots.astype(np.float64),
            slots - 1.0,
            self._first_slot[scene.type_index].astype(np.int32),
            far_m,
            far_m - near_m,
        )
        self._kept = Kept(self._gather)
        self._levels = SharedLevels(len(scene), int(self._slots.sum()))
        # By place, so that a slice does not depend on numbers, and lies all over the scene.
        self._all = np.lexsort(scene.center_m.T).astype(np.int32)
        self._list = self._all[:0]
        self._slice = 0

    def select(self, view: View) -> Selection:
        """Borrow or extract where the level shown is not similar to the one wanted."""
        self._steer(view)
        seen = view if self.active is None else view.at(self._looked_at(view))
        same = self._kept.of(seen)
        lod = self._wanted_lod(seen, same)
        step = same.slots * (lod if self.spacing == 1.0 else lod**self.spacing)
        np.minimum(step, same.last, out=step)
        slot = step.astype(np.int32)  # towards zero
        slot += same.first
        turns = self._turns(seen, lod, slot)
        if len(turns.at):
            self._update(seen, turns.at, lod[turns.at], slot[turns.at])
        # What an engine does: a look at each object, a sort, and a look at each slot wanted.
        compared = turns.visits + turns.differing * turns.differing.bit_length()
        work = Work(objects_visited=len(seen), comparisons=compared)
        detail = self._levels.detail
        if not self._any_shares:
            return Selection(view.ids, detail.take(view.nodes.at), work)
        source = self._levels.source.take(view.ids)
        return Selection(view.ids, detail.take(source), work, source)

    def _gather(self, seen: View) -> _Same:
        at, same = seen.nodes.at, self._of_node
        return _Same(
            same.slots.take(at),
            same.last.take(at),
            same.first.take(at),
            same.far_m.take(at),
            same.span_m.take(at),
        )

    def _looked_at(self, view: View) -> IntArray:
        """Return the list, this frame's slice of all objects, and those in view without a level."""
        some = self._all[self._slice :: self.refresh]
        self._slice = (self._slice + 1) % self.refresh
        new = view.ids[self._levels.source.take(view.ids) < 0]
        return np.unique(np.concatenate((self._list, some, new)))

    def _steer(self, view: View) -> None:
        time_ms = self._reports.newest_ms(view, view.completed.work_ms, self._target_ms)
        ratio = time_ms / self._target_ms
        if math.isnan(ratio) or abs(ratio - 1.0) <= self.dead_band:
            return
        step = self.gain if ratio > 1.0 else 1.0 / self.gain
        self._exponent = min(max(self._exponent * step, 1.0 / self.limit), self.limit)

    def _wanted_lod(self, seen: View, same: _Same) -> FloatArray:
        lod = same.far_m - seen.distance_m
        lod /= same.span_m
        np.minimum(np.maximum(lod, 0.0, out=lod), 1.0, out=lod)
        return lod if self._exponent == 1.0 else np.power(lod, self._exponent, out=lod)

    def _turns(self, seen: View, lod: FloatArray, slot: IntArray) -> _Turns:
        levels, n = self._levels, len(seen)
        if self.active is None and not self._any_shares:
            # All show their own levels, and whose turn comes first makes no difference.
            at = (levels.slot.take(seen.nodes.at) != slot).nonzero()[0]
            return _Turns(at, n if len(at) else 0, len(at))
        if self.active is not None:
            return self._turns_of_list(seen, lod, slot, self.active)
        shown, shown_lod = levels.shown(seen.ids)
        differs = shown != slot
        gap = np.where(differs, np.abs(lod - shown_lod), 0.0)
        gap[shown < 0] = np.inf
        at = self._concerned(seen, differs)
        visits = n if len(at) else 0
        return _Turns(in_order(seen, lod, slot, gap, at), visits, int(np.count_nonzero(differs)))

    def _turns_of_list(self, seen: View, lod: FloatArray, slot: IntArray, places: int) -> _Turns:
        """Return whose turn it is, and keep the list of the frame that follows."""
        levels, ids, inside = self._levels, seen.ids, seen.inside
        shown, shown_lod = levels.shown(ids)
        differs, new = shown != slot, (shown < 0) & inside
        gap = np.abs(lod - shown_lod)
        gap[~inside] *= self.outside
        # Who is outside would only keep a place from others where nothing can be borrowed.
        borrows = self._shares[seen.type_index] & (levels.source.take(ids) != ids)
        borrows &= differs & (gap > 0.0) & (levels.holder.take(slot) >= 0)
        gap[new] = np.inf
        at = np.flatnonzero(differs & (inside | borrows))
        turns = in_order(seen, lod, slot, gap, at)[: max(places, int(np.count_nonzero(new)))]
        likely = np.flatnonzero(~differs & inside)
        likely = likely[np.lexsort((seen.distance_m[likely], -gap[likely]))]
        self._list = ids[np.concatenate((turns, likely))[:places]]
        return _Turns(turns, len(turns), len(at))

    def _concerned(self, seen: View, differs: BoolArray) -> IntArray:
        """Return positions of objects that need another level, or borrow from one that may.

        All others would be left as they are: none borrows itself, and nobody takes a slot away.
        """
        source = self._levels.source.take(seen.ids)
        borrows = ~differs & (source != seen.ids)
        moving = np.zeros(len(seen.scene), dtype=np.bool_)
        concerned = differs
        while True:
            moving[seen.ids[concerned]] = True
            more = borrows & moving.take(source) & ~concerned
            if not more.any():
                return concerned.nonzero()[0]
            concerned = concerned | more

    def _update(self, seen: View, order: IntArray, lod: FloatArray, slot: IntArray) -> None:
        """Let the objects at these positions have their turns."""
        levels, node = self._levels, seen.ids.take(order)
        kind = seen.scene.type_index.take(node)
        detail = self._detail(seen.scene.types.levels, kind, lod, slot)
        inside = seen.state.inside[node]
        if not self._any_shares:
            # Whoever has a turn here needs another level, and nobody lends.
            at = inside.nonzero()[0]
            levels.extract(node[at], slot[at], lod[at], detail[at])
            return
        shares = self._shares[kind]
        shown, _ = levels.shown(node)
        own = np.flatnonzero(~shares & inside & (shown != slot))
        levels.extract(node[own], slot[own], lod[own], detail[own])
        at = np.flatnonzero(shares)
        levels.visit(node[at], slot[at], lod[at], detail[at], inside[at])

    def _detail(
        self, table: LevelTable, kind: IntArray, lod: FloatArray, slot: IntArray
    ) -> FloatArray:
        """Return resolutions of continuous types, and levels of discrete ones by their slots."""
        coarseness = table.level_count.take(kind) - 1 - (slot - self._first_slot.take(kind))
        if not self._any_soft:
            return coarseness.astype(np.float64)
        low = table.min_resolution[kind]
        return np.where(
            table.continuous[kind], np.minimum(low + lod * (1.0 - low), 1.0), coarseness
        )


def _slots_by_type(names: Sequence[str], slots: int, others: str) -> IntArray:
    """Return how many slots each type has; InputError if the text is not as ``ogre:64/tree:16``."""
    count = np.full(len(names), slots)
    for part in filter(None, others.split("/")):
        name, _, number = part.rpartition(":")
        if name not in names:
            raise InputError(f"lodmanager: slots_of: {unknown_name(name or part, sorted(names))}")
        if not (number.isascii() and number.isdigit() and int(number) > 0):
            raise InputError(f"lodmanager: slots_of: expected {name}:slots, 1 or more, got {part}")
        count[names.index(name)] = int(number)
    return count
