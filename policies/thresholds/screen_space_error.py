"""``screen-space-error``: refine while the projected error is above a tolerance."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.levels.error_ladder import ErrorLadder
from ..shared.ranges import Finite, Positive, check_parameters
from ..shared.trees.hierarchy import Hierarchy
from ..view import View

_STEP = 1.02  # CesiumJS: factor of the memory-adjusted error in a frame


@dataclass
class ScreenSpaceError:
    """Idea: refine while ``error · height / (2 · distance · tan(fovy / 2))`` is above a tolerance.

    Distance is to the nearest point of the bounding sphere, never below the near plane.  In a
    hierarchy a node whose error is above the tolerance gives way to its children (REPLACE), once
    those in the frustum are in memory, or is joined by those that are (ADD).  It wants in memory
    what it would draw with everything there, and what stands above that, by the error that each
    removes.  In a flat scene an object takes its coarsest level (or knot) within the
    tolerance.

    With `memory_bytes` the tolerance rises by 2 % a frame while the nodes wanted take more than
    that, and falls back as slowly.  There is no hysteresis.

    Uses: error and distance of nodes, residency.

    Parameters: `tolerance_px`, `memory_bytes`.

    Cost per frame: O(v), one visit for each node whose parent is refined.

    Reference: the refinement rule of 3D Tiles 1.1 (Open Geospatial Consortium); tolerance and
    memory adjustment as in CesiumJS (maximumScreenSpaceError, memoryAdjustedScreenSpaceError).
    """

    tolerance_px: Finite = 16.0  # CesiumJS and cesium-native
    memory_bytes: Positive | None = None  # None: off; CesiumJS adjusts to its cache of 512 MiB

    capabilities: ClassVar[Capabilities] = Capabilities(
        continuous=True, hierarchy=True, loader=True
    )
    knob: ClassVar[Knob] = Knob("tolerance_px", 0.05, 64.0, finer="lower")

    @property
    def claims(self) -> Claims:
        """What holds with these parameters: a tolerance steered by memory swings."""
        return Claims(settles_frames=0 if self.memory_bytes is None else None)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and start from the tolerance."""
        check_parameters(self, "screen-space-error")
        self._adjusted_px = self.tolerance_px
        self._chooser = ErrorLadder(scene) if scene.flat else Hierarchy(scene)
        levels = scene.types.levels
        self._node_bytes = np.add.reduceat(levels.bytes, levels.start[:-1])[scene.type_index]

    def select(self, view: View) -> Selection:
        """Return levels or a front within the tolerance."""
        if isinstance(self._chooser, ErrorLadder):
            return self._chooser.select(view, self.tolerance_px, 0.0)
        return self._front(self._chooser, view)

    def _front(self, tree: Hierarchy, view: View) -> Selection:
        scene, inside = tree.scene, view.state.inside
        seen = view.at(np.flatnonzero(inside))
        error_px = np.zeros(len(scene))
        error_px[seen.ids] = tree.error_m[seen.ids] * view.camera.focal_px / seen.nearest_m
        wish = tree.close(view, error_px > self._adjusted_px)
        reached = wish[scene.parent] & (scene.parent >= 0) & inside
        wanted = self._by_error(tree, reached, error_px)
        self._adjust(float(self._node_bytes[wanted].sum()))
        resident = view.at(np.arange(len(scene), dtype=np.int32)).resident
        ready = resident & (scene.additive | ~tree.waits(view))
        ids, detail = tree.front(view, tree.close(view, wish & ready))
        here = resident[ids]
        visited = len(view) + len(wanted)
        return Selection(ids[here], detail[here], Work(visited), wanted=wanted)

    def _by_error(self, tree: Hierarchy, reached: BoolArray, error_px: FloatArray) -> IntArray:
        """Return the nodes reached, by the error that each takes off its parent."""
        nodes = np.flatnonzero(reached).astype(np.int32)
        above = error_px[tree.scene.parent[nodes]]
        return nodes[np.lexsort((nodes, tree.tree.depth[nodes], -above))]

    def _adjust(self, needed_bytes: float) -> None:
        if self.memory_bytes is None:
            return
        step = _STEP if needed_bytes > self.memory_bytes else 1.0 / _STEP
        self._adjusted_px = max(self._adjusted_px * step, self.tolerance_px)
