"""Extraction and borrowing of levels of continuous models, charged to the CPU.

A continuous model (LodStrips, TOM) must rebuild its index set when its resolution changes; a
discrete level is ready to draw.  A node whose selection names another node as its holder draws that
node's index set instead, which only costs a changed reference (LODManager, section 3).
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.predictors import LEVEL_PREDICTORS
from ...models.scene.scene import Scene
from ...policies.selection import Selection
from .switches import Drawn

_TRIANGLES = LEVEL_PREDICTORS.index("triangles")


@dataclass(frozen=True, slots=True)
class Extraction:
    """Levels extracted, the triangles in them, and levels newly borrowed in one frame."""

    levels: int = 0
    triangles: float = 0.0
    borrowed: int = 0


_NOTHING = Extraction()


class IndexSets:
    """Which index set each of N nodes owns and draws; empty for scenes without continuous types."""

    def __init__(self, scene: Scene) -> None:
        self._levels = scene.types.levels
        self._continuous = scene.continuous if self._levels.continuous.any() else None
        # Discrete scenes own nothing, so that a replay of them keeps no arrays.
        nodes = 0 if self._continuous is None else len(scene)
        self._owned = np.full(nodes, np.nan)
        self._drawn_of = np.full(nodes, -1, dtype=np.int32)

    def record(self, selection: Selection, drawn: Drawn) -> Extraction:
        """Extract and borrow what a frame draws; return the counts.

        Raises
        ------
        ValueError
            If a node borrows from a holder whose index set has another resolution.
        """
        if self._continuous is None or not len(drawn.ids):
            return _NOTHING
        soft = np.flatnonzero(self._continuous[drawn.ids])
        ids, detail = drawn.ids[soft], drawn.detail[soft]
        # Who names no holder draws an index set of its own.
        holder = ids if selection.holder is None else selection.holder[soft]
        own = holder == ids
        extracted = np.flatnonzero(own & (self._owned[ids] != detail))
        # Before the check, so that a holder and its borrowers may change in the same frame.
        self._owned[ids[own]] = detail[own]
        _require_same(ids, holder, detail, self._owned)
        # To go on borrowing from the same node changes no reference, and is free.
        borrowed = int(np.count_nonzero(~own & (self._drawn_of[ids] != holder)))
        self._drawn_of[ids] = holder
        return Extraction(len(extracted), self._triangles(drawn, soft[extracted]), borrowed)

    def _triangles(self, drawn: Drawn, at: IntArray) -> float:
        assert drawn.fraction is not None, "a scene with continuous types has fractions"
        counts = self._levels.interpolate(
            self._levels.counts[:, _TRIANGLES], drawn.row[at], drawn.fraction[at]
        )
        return float(counts.sum())


def _require_same(ids: IntArray, holder: IntArray, detail: FloatArray, owned: FloatArray) -> None:
    wrong = np.flatnonzero(owned[holder] != detail)
    if len(wrong):
        i = wrong[0]
        raise ValueError(
            f"holder: node {ids[i]} draws resolution {detail[i]:g} of node {holder[i]}, expected "
            f"the holder's {owned[holder[i]]:g}"
        )
