"""The discrete half of a mixed scene where it is all there is: levels of flat scenes."""

from typing import NamedTuple

import numpy as np

from ....base.arrays import FloatArray
from ....models.machine.frame_cost import FrameCost
from ....models.scene.scene import Scene
from ...solvers.column_counts import count_true
from ...solvers.falling_cut import FallingCut
from ...solvers.increment_chains import IncrementChains
from ...view import View
from ..kept import Kept


class _Same(NamedTuple):
    """What is the same of m candidates in every frame.

    Attributes
    ----------
    cost_ms, ratio : (m, W) float64
        Of the increments from the coarsest level on; the ratio for an area of 1.
    importance, last : (m,) float64
        Importance, and the coarsest level.
    """

    cost_ms: FloatArray
    ratio: FloatArray
    importance: FloatArray
    last: FloatArray


class FlatLevels:
    """`Patches` of flat scenes of discrete types, where types alone say what levels cost.

    Benefit and increments are those of `Patches`; their ratios are areas times ratios of the type.

    Attributes
    ----------
    rising : bool
        Whether every finer level costs more.
    """

    def __init__(self, scene: Scene, costs: FrameCost) -> None:
        levels = scene.types.levels
        count = levels.level_count[:, None]
        step = np.arange(int(count.max()) - 1)
        self._void = void = step >= count - 1
        # Of step i the coarser level is the last but i.
        finer = np.maximum(levels.start[1:, None] - 2 - step, levels.start[:-1, None])
        self._cost_ms = np.where(void, 1.0, costs.level_ms[finer] - costs.level_ms[finer + ~void])
        gain = np.exp2(0.5 * (step + 1.0)) - np.exp2(0.5 * step)
        self.rising = bool((self._cost_ms > 0.0).all())
        ratio = np.divide(gain, self._cost_ms, out=np.ones(void.shape), where=self._cost_ms > 0.0)
        np.minimum.accumulate(ratio, axis=1, out=ratio)
        self._ratio = np.where(void, -1.0, ratio)
        self._scene, self._cut = scene, FallingCut()
        self._kept = Kept(self._gather)

    def _gather(self, view: View) -> _Same:
        nodes = view.nodes
        kind = nodes.type_at
        return _Same(
            self._cost_ms.take(kind, axis=0),
            self._ratio.take(kind, axis=0),
            nodes.importance,
            nodes.coarsest_level,
        )

    def coarsest(self, view: View) -> FloatArray:
        """Return the coarsest level of each candidate, (m,)."""
        return self._kept.of(view).last.copy()

    def increments(self, view: View) -> IncrementChains:
        """Return the increments of a frame."""
        same = self._kept.of(view)
        area = view.area_px * same.importance
        ratio = np.repeat(area, same.ratio.shape[1]).reshape(same.ratio.shape)
        ratio *= same.ratio
        return IncrementChains(same.cost_ms, ratio, self._cut)

    def detail(self, view: View, increments: IncrementChains) -> FloatArray:
        """Return the level of each candidate after the increments that were taken, (m,)."""
        return self._kept.of(view).last - count_true(np.ascontiguousarray(increments.taken.T))


def make_flat_levels(scene: Scene, costs: FrameCost) -> FlatLevels | None:
    """Return the levels of a flat scene of discrete types, or None where the view has a say.

    Nor where a finer level costs no more, since what gains at no cost has an infinite ratio.
    """
    if costs.model.has_roofline or not costs.linear_in_detail:
        return None
    levels = FlatLevels(scene, costs)
    return levels if levels.rising else None
