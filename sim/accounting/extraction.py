"""Extraction and borrowing of levels of continuous models, charged to the CPU.

A continuous model (LodStrips, TOM) must change its index set when its collapse step changes; a
discrete level is ready to draw.  A node whose selection names another node as its holder draws that
node's index set instead, which only costs a changed reference (LODManager, section 3).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...models.continuous.collapse_steps import (
    BYTES_PER_TRIANGLE,
    CollapseSteps,
    triangles_changed,
)
from ...models.scene.scene import Scene
from ...policies.selection import Selection
from .switches import Drawn

_NEVER = -1.0


class Extraction(NamedTuple):
    """What of index sets one frame changes.

    Attributes
    ----------
    levels : int
        Index sets that were made, or brought to another step.
    triangles_changed : float
        Triangles in them that are not as they were; all of a set that is new.
    bytes : float
        Of those sets, each uploaded whole.
    borrowed : int
        Nodes that newly draw another one's set.
    """

    levels: int = 0
    triangles_changed: float = 0.0
    bytes: float = 0.0
    borrowed: int = 0


_NOTHING = Extraction()


class IndexSets:
    """Which index set each of N nodes owns and draws; empty for scenes without continuous types."""

    def __init__(self, scene: Scene) -> None:
        levels = scene.types.levels
        self._scene = scene
        self._steps = CollapseSteps(levels)
        self._continuous = scene.continuous if levels.continuous.any() else None
        # Discrete scenes own nothing, so that a replay of them keeps no arrays.
        nodes = 0 if self._continuous is None else len(scene)
        self._owned = np.full(nodes, _NEVER)
        self._drawn_of = np.full(nodes, -1, dtype=np.int32)
        self._lends = False

    def record(
        self, selection: Selection, drawn: Drawn, changed: NDArray[np.intp] | None = None
    ) -> Extraction:
        """Extract and borrow what a frame draws; return what that changes.

        `changed` are the positions whose details are not those last drawn, if that is known.

        Raises
        ------
        ValueError
            If a node borrows from a holder whose index set has another resolution.
        """
        if self._continuous is None or not len(drawn.ids):
            return _NOTHING
        self._lends = self._lends or selection.holder is not None
        if not self._lends:
            # Each draws its own set, which is of another step only where the detail is another.
            at = np.arange(len(drawn.ids)) if changed is None else changed
            at = at[self._continuous.take(drawn.at.take(at))]
            ids = drawn.at.take(at)
            return self._extract(ids, self._level(ids, drawn.detail.take(at)))
        soft = np.flatnonzero(self._continuous[drawn.ids])
        ids, detail = drawn.ids[soft], drawn.detail[soft]
        # Who names no holder draws an index set of its own.
        holder = ids if selection.holder is None else selection.holder[soft]
        own, step = holder == ids, self._level(ids, detail)
        # Before the check, so that a holder and its borrowers may change in the same frame.
        extraction = self._extract(ids[own], step[own])
        self._require_same(ids, holder, detail, step)
        # To go on borrowing from the same node changes no reference, and is free.
        borrowed = int(np.count_nonzero(~own & (self._drawn_of[ids] != holder)))
        self._drawn_of[ids] = holder
        return extraction._replace(borrowed=borrowed)

    def _level(self, ids: IntArray, detail: FloatArray) -> FloatArray:
        return self._steps.level(self._scene.type_index.take(ids), detail)

    def _extract(self, ids: IntArray, step: FloatArray) -> Extraction:
        """Bring the sets of nodes to these steps."""
        owned = self._owned.take(ids)
        at = np.flatnonzero(owned != step)
        if not len(at):
            return _NOTHING
        node, now, before = ids[at], step[at], owned[at]
        self._owned[node] = now
        kind = self._scene.type_index.take(node)
        triangles = self._steps.triangles(kind, now)
        # A set that is new has no triangle of before.
        old = np.where(before < 0.0, 0.0, self._steps.triangles(kind, np.maximum(before, 0.0)))
        changed = triangles_changed(old, triangles)
        size = BYTES_PER_TRIANGLE * float(triangles.sum())
        return Extraction(len(at), float(changed.sum()), size)

    def _require_same(
        self, ids: IntArray, holder: IntArray, detail: FloatArray, step: FloatArray
    ) -> None:
        wrong = np.flatnonzero(self._owned[holder] != step)
        if not len(wrong):
            return
        i = int(wrong[0])
        owned = self._owned[holder[i : i + 1]]
        has = self._steps.resolution(self._scene.type_index[holder[i : i + 1]], owned)[0]
        expected = f"the holder's {has:g}" if owned[0] >= 0.0 else "one that has been extracted"
        raise ValueError(
            f"holder: node {ids[i]} draws resolution {detail[i]:g} of node {holder[i]}, expected "
            f"{expected}"
        )
