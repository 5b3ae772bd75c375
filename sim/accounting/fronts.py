"""Switches in a hierarchy: a node that gives way to its children, or takes their place, is one.

This is how the HLOD thesis counts (chapter 6): one toggle for a node however many children it has.
A reversal is a second toggle of the same node within `REVERSAL_NS`.  Levels changed are the nodes
drawn in the place of others, as each has content of its own.
"""

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...models.scene.tree import Tree
from ...policies.view import View
from .switches import REVERSAL_NS, SwitchCounts


class Fronts:
    """Which nodes of a tree were drawn in the last frame, and when each last gave way."""

    def __init__(self, tree: Tree, viewport_px: float, visible_px: float) -> None:
        n = len(tree.scene)
        levels = tree.scene.types.levels
        self._tree = tree
        self._viewport_px, self._visible_px = viewport_px, visible_px
        self._error_m = levels.error_m[levels.start[:-1]][tree.scene.type_index]
        self._drawn = np.zeros(n, dtype=np.bool_)
        self._inside = np.zeros(n, dtype=np.bool_)
        # Before the start by more than a reversal takes, so that no first switch is one.
        self._switch_ns = np.full(n, -REVERSAL_NS - 1, dtype=np.int64)

    def record(self, time_ns: int, ids: IntArray, view: View) -> SwitchCounts:
        """Record the front of a frame (nodes inside the frustum) and return its switches."""
        inside = view.state.inside
        now = np.zeros_like(self._drawn)
        now[ids] = True
        # Only nodes in view in both frames: coming into view or leaving it is no switch.
        both = inside & self._inside
        came = np.flatnonzero(now & ~self._drawn & both)
        went = np.flatnonzero(self._drawn & ~now & both)
        # Nearest ancestors that ceased to be drawn gave way, and those that are drawn anew take
        # their place back; one that stays drawn beside its children (additive) did neither.
        refined = self._tree.first_in(self._drawn & ~now, came)
        coarsened = self._tree.first_in(now & ~self._drawn, went)
        # A node that gives way to many children is found once for each of them.
        switched = np.unique(np.concatenate((refined, coarsened)))
        switched = switched[switched >= 0]
        reversals = np.count_nonzero(time_ns - self._switch_ns[switched] <= REVERSAL_NS)
        self._switch_ns[switched] = time_ns
        refined_px, seen_refining = self._popping(view, came, refined)
        coarsened_px, seen_coarsening = self._popping(view, went, coarsened)
        visible = np.unique(np.concatenate((seen_refining, seen_coarsening)))
        self._drawn = now
        # The culler fills the same array again in the next frame.
        self._inside = inside.copy()
        popping_px = refined_px + coarsened_px
        return SwitchCounts(len(switched), int(reversals), popping_px, len(visible), len(came))

    def _popping(self, view: View, finer: IntArray, coarser: IntArray) -> tuple[float, IntArray]:
        """Return the popping of switches, and the coarser nodes of those that are seen."""
        finer, coarser = finer[coarser >= 0], coarser[coarser >= 0]
        if not len(finer):
            return 0.0, coarser
        seen = view.at(finer)
        px_per_m: FloatArray = view.camera.focal_px * self._tree.scene.scale[finer]
        # As large as the finer node is on the screen: there the picture changes.
        step = np.abs(self._error_m[coarser] - self._error_m[finer]) * px_per_m / seen.nearest_m
        areas_px = [float(step @ area_px) for area_px in seen.areas_px]
        popping_px = max(areas_px) / self._viewport_px
        return popping_px, coarser[step >= self._visible_px]
