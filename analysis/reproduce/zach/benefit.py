"""What a selection on `styria` is worth by the paper's own sums, apart from the policy's."""

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....base.predictors import LEVEL_PREDICTORS
from ....models.scene.scene import Scene
from ....models.scene.tree import Tree
from ....policies.selection import Selection
from ....policies.view import View

_TREES = LEVEL_PREDICTORS.index("draw_calls")
_SPLATS = LEVEL_PREDICTORS.index("splats")
_K, _LARGEST_GROUP = 1.0 / 16.0, 64.0


class PaperBenefit:
    """``Σ sqrt(2^d) · S`` of patches and ``Σ k S² (N / 64) sqrt(x / N · N_splats)`` of groups.

    d is the depth of a patch, S the area of the finest patches in view below it; of a group of N
    trees S² is its area (see `Zach`, whose readings these are).
    """

    def __init__(self, scene: Scene) -> None:
        levels = scene.types.levels
        finest = levels.counts[levels.start[:-1]][scene.type_index]
        self._scene, self._depth = scene, Tree(scene).depth
        self._patches = np.flatnonzero((finest[:, _SPLATS] == 0.0) & (finest[:, _TREES] > 0.0))
        self._trees = np.maximum(finest[:, _TREES], 1.0)
        self._per_tree = finest[:, _SPLATS] / self._trees

    def trees_in_view(self, view: View) -> float:
        """Return how many trees are in groups in view, however small these are."""
        return float(self._trees[view.state.inside & (self._per_tree > 0.0)].sum())

    def of(self, view: View, selection: Selection) -> tuple[float, float]:
        """Return the benefit of the terrain and of the trees of a selection."""
        inside = view.state.inside
        at = selection.ids
        splats = self._per_tree[at] > 0.0
        groups, resolution = at[splats], selection.detail[splats]
        area_px = view.at(groups).area_px
        per_tree = np.sqrt(resolution * self._per_tree[groups])
        trees = _K * area_px * self._trees[groups] / _LARGEST_GROUP * per_tree
        patches = at[~splats & inside[at]]
        worth = np.sqrt(2.0 ** self._depth[patches]) * self._patch_px(view)[patches]
        return float(worth.sum()), float(trees.sum())

    def _patch_px(self, view: View) -> FloatArray:
        """Return the area of the finest patches in view at and below each, (N,)."""
        inside, depth = view.state.inside, self._depth[self._patches]
        total = np.zeros(len(self._scene))
        for layer in range(int(depth.max()), -1, -1):
            here: IntArray = self._patches[depth == layer]
            if layer == depth.max():
                seen = here[inside[here]].astype(np.int32)
                total[seen] = view.at(seen).area_px
            if layer:
                # What is culled stands below what is in view above it, with all that is seen of it.
                np.add.at(total, self._scene.parent[here], total[here])
        return total
