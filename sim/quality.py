"""Error, benefit and degradation of what a frame shows, held against full detail."""

from dataclasses import dataclass

import numpy as np

from ..models.arrays import FloatArray, IntArray
from ..models.benefit import BASE_ERROR, level_accuracy, level_primitives
from ..models.scene import Scene
from ..models.tree import Tree
from ..policies.view import View
from .switches import Drawn

__all__ = ["FlatQuality", "Quality", "TreeQuality", "screen_errors"]


@dataclass(frozen=True, slots=True)
class Quality:
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
    rank = int(0.95 * (len(sse_px) - 1))
    sse_px.partition(rank)
    return float(sse_px[rank]), float(sse_px[rank:].max())


class FlatQuality:
    """Quality of scenes without a hierarchy, from tables of one entry a level."""

    def __init__(self, scene: Scene) -> None:
        levels = scene.types.levels
        self._scene, self._levels = scene, levels
        primitives = np.maximum(level_primitives(levels), 1.0)
        self._accuracy = level_accuracy(levels)
        # Gobbetti-Bouvier's a_i r_i^-1 with a_i = importance · area / n_i is importance · area over
        # the primitives drawn, so one reciprocal a level serves both.
        self._per_primitive = 1.0 / primitives
        finest = levels.start[:-1]
        self._full_accuracy = self._accuracy[finest]
        self._full_per_primitive = self._per_primitive[finest]
        self._unit_importance = bool((scene.importance == 1.0).all())

    def units(self, view: View) -> View:
        """Return the view of all objects in the frustum: the candidates."""
        return view

    def score(self, drawn: Drawn, units: View) -> Quality:
        """Return the quality of a frame over the `units` in its frustum."""
        weight = whole = self._weight(units.ids, units.area_px)
        full_benefit = float(whole @ self._full_accuracy[units.type_index])
        full_degradation = float(whole @ self._full_per_primitive[units.type_index])
        missing = len(units.ids) - len(drawn.ids)
        if drawn.ids is not units.ids:
            weight = self._weight(drawn.ids, drawn.area_px)
        accuracy, per_primitive = self._accuracy, self._per_primitive
        if drawn.fraction is None:
            benefit = float(weight @ accuracy[drawn.row])
            degradation = float(weight @ per_primitive[drawn.row])
        else:
            lerp = self._levels.interpolate
            benefit = float(weight @ lerp(accuracy, drawn.row, drawn.fraction))
            degradation = float(weight @ lerp(per_primitive, drawn.row, drawn.fraction))
        if missing:
            degradation += float(whole.sum() - weight.sum())
        return Quality(benefit, full_benefit, degradation, full_degradation, missing)

    def _weight(self, ids: IntArray, area_px: FloatArray) -> FloatArray:
        return area_px if self._unit_importance else area_px * self._scene.importance[ids]


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
        fraction = np.zeros(len(drawn.ids)) if drawn.fraction is None else drawn.fraction
        now[drawn.ids] = levels.interpolate(level_primitives(levels), drawn.row, fraction)
        cover = tree.cover(drawn.ids)[units.ids]
        full = tree.primitives[units.ids]
        below = np.maximum(tree.leaf_primitives[cover], 1.0)
        share = np.where(cover == units.ids, 1.0, full / below)
        samples = np.where(cover >= 0, now[cover] * share, 0.0)
        return Quality(
            float(weight @ _accuracy(samples)),
            float(weight @ _accuracy(full)),
            float(weight @ (1.0 / np.maximum(samples, 1.0))),
            float(weight @ (1.0 / np.maximum(full, 1.0))),
            int(np.count_nonzero(cover < 0)),
        )


def _accuracy(samples: FloatArray) -> FloatArray:
    """Return ``1 - BASE_ERROR / samples``, 0 below one sample."""
    return np.where(samples >= 1.0, 1.0 - BASE_ERROR / np.maximum(samples, 1.0), 0.0)
