"""Error, benefit and degradation of what a frame shows, beside those of full detail."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray
from ...models.scene.benefit import BASE_ERROR, level_accuracy, level_primitives
from ...models.scene.scene import Scene
from ...models.scene.tree import Tree
from ...policies.view import View
from .switches import Drawn


class Quality(NamedTuple):
    """Sums over one frame; `missing` counts objects (units of a tree) of which nothing is drawn.

    What is missing has no benefit, and degrades as if it were drawn with a single primitive.
    """

    benefit: float
    full_benefit: float
    degradation: float
    full_degradation: float
    missing: int


def screen_errors(drawn: Drawn) -> tuple[float, float]:
    """Return the 95th percentile (lower rank) and maximum of drawn nodes' errors in px."""
    if not len(drawn.ids):
        return 0.0, 0.0
    sse_px = drawn.error_m * drawn.px_per_m
    # Only the rank is needed: partition is O(n), where a sort or a quantile is not.
    rank = int(0.95 * (len(sse_px) - 1))
    sse_px.partition(rank)
    return float(sse_px[rank]), float(sse_px[rank:].max())


class FlatQuality:
    """Quality of scenes without a hierarchy, from tables of one entry a level."""

    def __init__(self, scene: Scene) -> None:
        levels = scene.types.levels
        self._scene, self._levels = scene, levels
        self._any_continuous = bool(levels.continuous.any())
        self._finest = levels.start[:-1].astype(np.int64)
        self._primitives = level_primitives(levels)
        # Gobbetti-Bouvier's a_i r_i^-1 with a_i = importance · area / n_i is importance · area over
        # the primitives drawn, so one reciprocal a level serves both.
        per_primitive = 1.0 / np.maximum(self._primitives, 1.0)
        self._per_level = np.stack((level_accuracy(levels), per_primitive))
        self._unit_importance = bool((scene.importance == 1.0).all())

    def units(self, view: View) -> View:
        """Return the view of all objects in the frustum: the candidates."""
        return view

    def score(self, drawn: Drawn, units: View) -> Quality:
        """Return the quality of a frame over the `units` in its frustum."""
        # Where all candidates are drawn, what is drawn weighs as much as what could be.
        weight = whole = self._weight(units.ids, units.area_px)
        full_row = self._finest.take(units.type_index)
        full = np.zeros(len(units)) if self._any_continuous else None
        full_benefit, full_degradation = self._sums(whole, full_row, full)
        if drawn.ids is not units.ids:
            weight = self._weight(drawn.ids, drawn.area_px)
        benefit, degradation = self._sums(weight, drawn.row, drawn.fraction)
        missing = len(units.ids) - len(drawn.ids)
        if missing:
            # One primitive for each that is missing: its whole weight, over 1.
            degradation += float(whole.sum() - weight.sum())
        return Quality(benefit, full_benefit, degradation, full_degradation, missing)

    def _sums(
        self, weight: FloatArray, row: NDArray[np.int64], fraction: FloatArray | None
    ) -> tuple[float, float]:
        """Return the weighted sums of accuracy and of one over primitives."""
        if fraction is None:
            # Sums by level before they meet the tables, as many objects share one.
            # numpy's stubs say that bincount returns integers with weights too.
            per_row: Any = np.bincount(row, weight, len(self._primitives))
            sums = np.add.reduce(self._per_level * per_row, axis=1)
        else:
            primitives = self._levels.interpolate(self._primitives, row, fraction)
            scores = np.stack((_accuracy(primitives), 1.0 / np.maximum(primitives, 1.0)))
            sums = np.add.reduce(scores * weight, axis=1)
        return float(sums[0]), float(sums[1])

    def _weight(self, ids: IntArray, area_px: FloatArray) -> FloatArray:
        return area_px if self._unit_importance else area_px * self._scene.importance.take(ids)


class TreeQuality:
    """Quality of hierarchies: each unit of full detail is judged by what stands for it.

    A leaf below a drawn node has that node's samples in proportion to its share of the primitives
    of all leaves below the node, so that fronts of any depth are scored over the same units.
    """

    def __init__(self, tree: Tree) -> None:
        self._tree = tree

    def units(self, view: View) -> View:
        """Return the view of all units in the frustum."""
        units = self._tree.units
        return view.at(units[view.state.inside[units]])

    def score(self, drawn: Drawn, units: View) -> Quality:
        """Return the quality of a frame over the `units` in its frustum."""
        tree, levels = self._tree, self._tree.scene.types.levels
        weight = units.area_px * tree.scene.importance[units.ids]
        now = np.zeros(len(tree.scene))
        # Interpolated at knots where all nodes are discrete: one path for both.
        fraction = np.zeros(len(drawn.ids)) if drawn.fraction is None else drawn.fraction
        now[drawn.ids] = levels.interpolate(level_primitives(levels), drawn.row, fraction)
        cover = tree.cover(drawn.ids)[units.ids]
        full = tree.primitives[units.ids]
        # Of a unit that is drawn itself the share is 1, whatever stands below it (additive nodes).
        below = np.maximum(tree.leaf_primitives[cover], 1.0)
        share = np.where(cover == units.ids, 1.0, full / below)
        # Nothing drawn above or at a unit is no samples: benefit 0, degradation as of one.
        samples = np.where(cover >= 0, now[cover] * share, 0.0)
        return Quality(
            float((weight * _accuracy(samples)).sum()),
            float((weight * _accuracy(full)).sum()),
            float((weight / np.maximum(samples, 1.0)).sum()),
            float((weight / np.maximum(full, 1.0)).sum()),
            int(np.count_nonzero(cover < 0)),
        )


def _accuracy(samples: FloatArray) -> FloatArray:
    """Return ``1 - BASE_ERROR / samples``, 0 below one sample."""
    return np.where(samples >= 1.0, 1.0 - BASE_ERROR / np.maximum(samples, 1.0), 0.0)
