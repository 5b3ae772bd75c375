"""Levels of flat scenes by hulls that are the same in every frame."""

from typing import NamedTuple

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....models.machine.frame_cost import FrameCost
from ....models.scene.benefit import level_primitives
from ....models.scene.scene import Scene
from ...solvers.shared_hulls import SharedHulls
from ...view import View
from ..kept import Kept
from .choices import accuracy_of, distinct


class Same(NamedTuple):
    """What is the same of some candidates in every frame.

    Attributes
    ----------
    kind : (n,) int
        Their types.
    types : int
        How many distinct ones.
    alternatives : int
        Sum of their levels.
    """

    kind: IntArray
    types: int
    alternatives: int


class Levels(NamedTuple):
    """Levels of a frame's candidates.

    Attributes
    ----------
    column : (n,) int
        Level of each, that of a knot for continuous types.
    detail : (n,) float64
        What a selection calls it.
    gpu_ms : float
        What the frame costs.
    alternatives : int
        Sum of the candidates' levels.
    """

    column: IntArray
    detail: FloatArray
    gpu_ms: float
    alternatives: int


class LevelHulls:
    """The knapsack of `LevelChoices` where types alone say by what costs of levels differ.

    They do without a roofline and without terms of the view that read levels.
    """

    def __init__(self, scene: Scene, costs: FrameCost, exponent: float, factor: FloatArray) -> None:
        """Take rows of factors, (F, L), one of which multiplies the benefits of an object."""
        levels = scene.types.levels
        self._costs, self._count = costs, levels.level_count
        columns: IntArray = np.arange(int(levels.level_count.max()))
        row = levels.rows_by_type()
        lacking = columns >= levels.level_count[:, None]
        cost_ms = np.where(lacking, np.inf, costs.level_ms[row])
        accuracy = accuracy_of(level_primitives(levels)[row], exponent)
        # A class for each type and row of factors.
        value = (accuracy[:, None, :] * factor).reshape(-1, len(columns))
        self._hulls = SharedHulls(np.repeat(cost_ms, len(factor), axis=0), value)
        self._factors = len(factor)
        self._detail = np.where(levels.continuous[:, None], levels.resolution[row], columns)
        self._kept = Kept(self._gather)

    def choose(
        self,
        view: View,
        size: FloatArray,
        budget_ms: float,
        *,
        row: IntArray | None = None,
        skip_misfits: bool,
        or_single: bool = False,
    ) -> Levels:
        """Return the greedy selection, as `SharedHulls.choose`, within what the frame may cost.

        `size` is benefit beyond accuracy, and `row` each candidate's row of factors, the first if
        not told, (n,).
        """
        same = self._kept.of(view)
        kind = same.kind if self._factors == 1 else same.kind * self._factors
        if row is not None:
            kind = kind + row
        rest_ms = self._rest_ms(view, same)
        choice = self._hulls.choose(
            kind, size, budget_ms - rest_ms, skip_misfits=skip_misfits, or_single=or_single
        )
        detail = self._detail.take(same.kind * self._detail.shape[1] + choice.column)
        return Levels(choice.column, detail, rest_ms + choice.cost, same.alternatives)

    def bound(self, view: View, size: FloatArray, budget_ms: float) -> float:
        """Return the most benefit that any selection within the budget has, by the first factors.

        `size` is benefit beyond accuracy, (n,).  It is the optimum of the linear relaxation.
        """
        same = self._kept.of(view)
        kind = same.kind if self._factors == 1 else same.kind * self._factors
        return self._hulls.bound(kind, size, budget_ms - self._rest_ms(view, same))

    def _rest_ms(self, view: View, same: Same) -> float:
        """Return what no level decides."""
        fixed_ms = self._costs.fixed_ms(view.viewport_px, same.types, len(view))
        return fixed_ms + self._costs.anyway_ms(view)

    def _gather(self, view: View) -> Same:
        kind = view.nodes.type_at
        return Same(kind, distinct(kind), int(self._count.take(kind).sum()))


def make_level_hulls(
    scene: Scene, costs: FrameCost, exponent: float, factor: FloatArray
) -> LevelHulls | None:
    """Return hulls of a scene's levels, or None where they are not the same in every frame."""
    if not scene.flat or costs.model.has_roofline or not costs.linear_in_detail:
        return None
    return LevelHulls(scene, costs, exponent, factor)
