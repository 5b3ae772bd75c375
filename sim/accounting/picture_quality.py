"""Benefit and degradation of what a frame shows, beside those of full detail."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, sum_rows
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


class FlatQuality:
    """Quality of scenes without a hierarchy, from tables of one entry a level."""

    def __init__(self, scene: Scene) -> None:
        levels = scene.types.levels
        self._levels = levels
        self._primitives = level_primitives(levels)
        # Gobbetti-Bouvier's a_i r_i^-1 with a_i = importance · area / n_i is importance · area over
        # the primitives drawn, so one reciprocal a level serves both.
        per_primitive = 1.0 / np.maximum(self._primitives, 1.0)
        each = np.stack((level_accuracy(levels), per_primitive))
        finest = levels.start[levels.type_of_level]
        # Of each level its own, then those of its type's finest level.
        self._per_level = np.concatenate((each, each.take(finest, axis=1)))
        self._unit_importance = bool((scene.importance == 1.0).all())

    def units(self, view: View) -> View:
        """Return the view of all objects in the frustum: the candidates."""
        return view

    def score(self, drawn: Drawn, units: View) -> Quality:
        """Return the quality of a frame over the `units` in its frustum."""
        weight = self._weight(drawn.seen)
        # By level, as many objects share one; then few products are left.
        by_level: Any = np.bincount(drawn.row, weight, len(self._primitives))
        benefit, degradation, full_benefit, full_degradation = sum_rows(self._per_level, by_level)
        if drawn.fraction is not None:
            primitives = self._levels.interpolate(self._primitives, drawn.row, drawn.fraction)
            benefit = float(np.add.reduce(weight * _accuracy(primitives)))
            degradation = float(np.add.reduce(weight / np.maximum(primitives, 1.0)))
        missing = len(units.ids) - len(drawn.ids)
        if missing:
            whole = self._weight(units)
            finest = self._per_level[:2].take(units.nodes.finest_row, axis=1)
            full_benefit, full_degradation = sum_rows(finest, whole)
            # One primitive for each that is missing: its whole weight, over 1.
            degradation += float(whole.sum() - weight.sum())
        return Quality(benefit, full_benefit, degradation, full_degradation, missing)

    def find_missing(self, drawn: Drawn, units: View) -> NDArray[np.intp]:
        """Return the positions of `units` of which nothing is drawn."""
        return (~np.isin(units.ids, drawn.ids)).nonzero()[0]

    def _weight(self, view: View) -> FloatArray:
        return view.area_px if self._unit_importance else view.area_px * view.nodes.importance


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

    def find_missing(self, drawn: Drawn, units: View) -> NDArray[np.intp]:
        """Return the positions of `units` of which nothing is drawn."""
        return (self._tree.cover(drawn.ids)[units.ids] < 0).nonzero()[0]


def _accuracy(samples: FloatArray) -> FloatArray:
    """Return ``1 - BASE_ERROR / samples``, 0 below one sample."""
    return np.where(samples >= 1.0, 1.0 - BASE_ERROR / np.maximum(samples, 1.0), 0.0)
