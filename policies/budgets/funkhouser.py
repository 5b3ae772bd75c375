"""``funkhouser``: most benefit within a predicted cost, one level an object."""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.knobs import AIM
from ..shared.levels.choices import make_choices, require_costs
from ..shared.levels.level_hulls import LevelHulls, make_level_hulls
from ..shared.ranges import Aim, BelowOne, Count, NotNegative, Positive, UpToOne, check_parameters
from ..shared.times.v_time import VTime
from ..solvers.knapsack import affordable, best_single, hull_increments, take_increments
from ..solvers.value_greedy import greedy_by_value, improve_incrementally
from ..view import View


@dataclass
class Funkhouser:
    """Idea: maximise Σ benefit subject to Σ cost ≤ budget, a multiple-choice knapsack a frame.

    Benefit = size · accuracy · importance · focus · motion · hysteresis.  Size is the projected
    area, accuracy ``1 - 0.5 / samples^exponent``.  Focus, motion and hysteresis were never
    published; ours are ``1 - focus · eccentricity / half the diagonal field of view``,
    ``1 / (1 + motion · apparent speed in 1/60 s over angular size)`` and
    ``1 / (1 + hysteresis · |level - last level|)``.

    With `mode` ``greedy``, tuples of object and level are taken by falling benefit per cost, as in
    the paper.  ``incremental`` is the paper's second algorithm, which starts from the last frame's
    levels.  ``hull`` takes increments on the upper hull by falling slope, or the best single
    increment if that is worth more, and so has at least half of the optimum, which the paper's
    order has not.  `misfit` says whether the hull order ends at the first increment that does not
    fit; going on makes small camera moves flip levels.  With `skip` objects may be left out, as in
    the paper; without it every object is at least at its coarsest level, over budget if need be.
    In a hierarchy a root's levels are the fronts of uniform depth below it, then coarser knots of
    the continuous nodes of the coarsest front; a front brings what the leaves below it do, as in
    the score, since spheres of inner nodes are loose.

    Uses: the scene's cost model, projected area, eccentricity, apparent speed, last levels.

    Parameters: as below.

    Cost per frame: O(n L log(n L)) for n objects of L levels.

    Reference: Funkhouser and Séquin, "Adaptive display algorithm for interactive frame rates during
    visualization of complex virtual environments", SIGGRAPH 1993; hull order after Sinha and
    Zoltners 1979, as PlayCanvas ships it for Gaussian splats.
    """

    mode: Literal["greedy", "incremental", "hull"] = "hull"  # ours: the one with a bound
    misfit: Literal["stop", "skip"] = "stop"  # as PlayCanvas: skipping flips levels
    skip: bool = False  # the paper may leave objects out; a missing object is the worst pop
    exponent: Positive = 1.0  # flat shading; 2 (Gouraud) puts every level above 0.9999
    focus: BelowOne = 0.5  # ours
    motion: NotNegative = 0.5  # ours
    hysteresis: NotNegative = 1e-4  # ours: of the order of accuracy steps between levels
    max_steps: Count = 64  # ours: exchanges of the incremental form a frame
    adapt: UpToOne = 0.0  # how fast predictions follow measured times; 0.2 with noise
    aim: Aim = 1.0  # share of the budget that the predicted time may take

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True, hierarchy=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with these parameters: exchanges of large scenes take many frames.

        With `adapt` the budget is kept by what frames took, not by the cost model.
        """
        if self.adapt:
            return Claims()
        settles_frames = None if self.mode == "incremental" else 8
        return Claims(budget=self.aim <= 1.0, settles_frames=settles_frames)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and tabulate the scene's levels."""
        check_parameters(self, "funkhouser")
        costs = require_costs(scene, "funkhouser")
        self._choices = make_choices(scene, costs, self.exponent)
        self._hulls = None
        if self.mode == "hull" and not self.skip:
            # Rows by the last level: the first for objects that were not drawn, which have none.
            width = int(scene.types.levels.level_count.max())
            lasts = np.arange(-1, width if self.hysteresis else 0, dtype=np.int32)
            factor = self._hold(np.ones((len(lasts), width)), lasts)
            self._hulls = make_level_hulls(scene, costs, self.exponent, factor)
        self._budget_ms = self.aim * budget_ms
        self._v_time = VTime(self.adapt)
        self._column = np.full(len(scene), -1, dtype=np.int32)

    def select(self, view: View) -> Selection:
        """Return the selection of most benefit that the mode finds within the budget."""
        whole_ms = self._v_time.budget_ms(view, self._budget_ms)
        if self._hulls is not None:
            return self._select_on_hulls(self._hulls, view, whole_ms)
        offer = self._choices.offer(view, self._weight)
        if not len(offer.objects):
            expected_ms = self._v_time.expect(offer.fixed_ms)
            return Selection(view.ids, np.zeros(0), predicted_ms=expected_ms)
        last = self._column[offer.objects]
        cost_ms, benefit = offer.cost_ms, self._hold(offer.benefit, last)
        real = np.isfinite(cost_ms).sum(axis=1)
        if self.skip:
            cost_ms, benefit = _with_nothing(cost_ms, benefit, real)
        budget_ms = whole_ms - offer.fixed_ms
        column, steps = self._choose(cost_ms, benefit, budget_ms, last)
        drawn = column < real
        self._column.fill(-1)
        self._column[offer.objects[drawn]] = column[drawn]
        ids, detail = self._choices.drawn(view, np.where(drawn, column, 0), drawn)
        predicted_ms = offer.fixed_ms + float(cost_ms[np.arange(len(column)), column].sum())
        tuples = int(real.sum())
        work = Work(len(column), tuples * tuples.bit_length(), steps)
        return Selection(ids, detail, work, predicted_ms=self._v_time.expect(predicted_ms))

    def _weight(self, view: View) -> FloatArray:
        """Return importance, focus and motion of nodes."""
        camera = view.camera
        half_px = 0.5 * np.hypot(camera.width_px, camera.height_px)
        half_deg = float(np.degrees(np.arctan2(half_px, camera.focal_px)))
        weight = view.scene.importance.take(view.ids)
        if self.focus:
            away = view.eccentricity_deg / half_deg
            np.minimum(away, 1.0, out=away)
            away *= self.focus
            weight *= np.subtract(1.0, away, out=away)
        if self.motion:
            size_deg = np.degrees(2.0 * np.arctan2(view.radius_m, view.nearest_m))
            size_deg *= 60.0
            slower = np.divide(view.speed_deg_s, size_deg, out=size_deg)
            slower *= self.motion
            slower += 1.0
            weight /= slower
        return weight

    def _hold(self, benefit: FloatArray, last: IntArray) -> FloatArray:
        """Return benefits with the hysteresis factor; objects that were not drawn have none."""
        if not self.hysteresis:
            return benefit
        columns = np.arange(benefit.shape[1], dtype=np.int32)
        away: IntArray = np.abs(columns - last[:, None])
        away[last < 0] = 0
        return benefit / (1.0 + self.hysteresis * away)

    def _select_on_hulls(self, hulls: LevelHulls, view: View, budget_ms: float) -> Selection:
        """Return the selection of mode `hull` where hulls are the same in every frame."""
        size = view.area_px * self._weight(view)
        row = self._column.take(view.ids) + 1 if self.hysteresis else None
        levels = hulls.choose(
            view, size, budget_ms, row=row, skip_misfits=self.misfit == "skip", or_single=True
        )
        self._column.fill(-1)
        self._column[view.ids] = levels.column
        tuples = levels.alternatives
        work = Work(len(view), tuples * tuples.bit_length())
        expected_ms = self._v_time.expect(levels.gpu_ms)
        return Selection(view.ids, levels.detail, work, predicted_ms=expected_ms)

    def _choose(
        self, cost_ms: FloatArray, benefit: FloatArray, budget_ms: float, last: IntArray
    ) -> tuple[IntArray, int]:
        """Return a column for each object, and steps of iteration."""
        coarsest = np.isfinite(cost_ms).sum(axis=1) - 1
        if self.mode == "greedy":
            return greedy_by_value(cost_ms, benefit, budget_ms, coarsest), 0
        if self.mode == "incremental":
            start = np.where(last < 0, coarsest, last)
            return improve_incrementally(cost_ms, benefit, budget_ms, start, self.max_steps)
        cost_ms = affordable(cost_ms, budget_ms)
        increments = hull_increments(cost_ms, benefit)
        choice = take_increments(increments, budget_ms, skip_misfits=self.misfit == "skip")
        single, single_benefit = best_single(cost_ms, benefit, increments, budget_ms)
        return (single if single_benefit > choice.benefit else choice.column), 0


def _with_nothing(
    cost_ms: FloatArray, benefit: FloatArray, real: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return alternatives with one more behind each row's last: drawing nothing, free of cost."""
    rows = np.arange(len(real))
    cost_ms = np.column_stack((cost_ms, np.full(len(real), np.inf)))
    benefit = np.column_stack((benefit, np.zeros(len(real))))
    cost_ms[rows, real] = 0.0
    benefit[rows, real] = 0.0
    return cost_ms, benefit
