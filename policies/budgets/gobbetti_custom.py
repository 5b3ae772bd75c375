"""``gobbetti-custom``: cost and degradation as a user's formulas."""

import logging
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.knobs import AIM
from ..shared.ranges import Aim, PositiveInt, check_parameters
from ..shared.resolutions.steady_costs import make_resolution_costs
from ..solvers.convex_program import ConvexProgram, Point
from ..view import View

_NAMES = (
    "area",
    "triangles",
    "importance",
    "speed",
    "eccentricity",
    "distance",
    "fixed_ms",
    "slope_ms",
)
_SCENE_COST = "fixed_ms + slope_ms * r"
_FEWEST_PLACES = 16
_INTERIOR = 1e-6  # an interior point stops this far, or less, short of a bound or a level
_KEPT_BACK = 1e-5  # share of the budget that making up for it may take
_log = logging.getLogger(__name__)


@dataclass
class GobbettiCustom:
    """Idea: `gobbetti` with formulas of your own, which is where a new heuristic is tried.

    Minimises the sum of `degradation` over resolutions while the sum of `cost` and what the frame
    costs before its first object keep the budget.  Formulas are of ``r`` (resolution) and, for each
    object, ``area`` (px), ``triangles`` (in full), ``importance``, ``speed`` (degrees a second),
    ``eccentricity`` (degrees), ``distance`` (m), and the scene's own cost ``fixed_ms + slope_ms *
    r``; they have ``+ - * / **``, sqrt, exp, log, log10, abs, min and max.  casadi derives them and
    ipopt solves, from the last frame's point.  The optimum is global if both are convex in r.
    Where ipopt fails, the last frame's resolutions are drawn if they fit, with newcomers at their
    lowest, else the lowest; `failures` counts such frames and the first is logged.  Discrete types
    get the finest level not above their resolution.

    Uses: the cost model, projected area, apparent speed, eccentricity, distance, importance, its
    own last resolutions.

    Parameters: `degradation`, `cost` (by default the scene's cost model), `max_iterations` (of
    ipopt), `aim`.

    Cost per frame: some ten iterations of an interior-point method, a hundred times `gobbetti`.

    Reference: Gobbetti and Bouvier, Time-critical multiresolution scene rendering, IEEE
    Visualization 1999, where heuristics are free as long as the problem is convex; symbols and
    solver are ours.
    """

    degradation: str = "importance * area / triangles / r"  # as gobbetti with m = 1
    cost: str | None = None  # None: the scene's cost model
    max_iterations: PositiveInt = 200  # ours: ten times what smooth formulas take
    aim: Aim = 1.0  # share of the budget that the predicted time may take
    failures: int = field(init=False, repr=False, compare=False, default=0)

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = AIM

    @property
    def claims(self) -> Claims:
        """What holds with these formulas and this aim."""
        return Claims(budget=self.cost is None and self.aim <= 1.0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters, parse the formulas, and forget the last frame."""
        check_parameters(self, "gobbetti-custom")
        self._costs = make_resolution_costs(scene, "gobbetti-custom")
        self._budget_ms = self.aim * budget_ms
        self._program = self._build(_FEWEST_PLACES)
        self._last = np.zeros((2, len(scene)))
        self._budget_multiplier = 0.0
        self.failures = 0

    def select(self, view: View) -> Selection:
        """Return the resolutions that the formulas make optimal."""
        costs = self._costs
        if not len(view):
            return Selection(view.ids, np.zeros(0), predicted_ms=costs.fixed_ms(view))
        frame = self._frame(view)
        point = self._solve(frame)
        work = Work(len(view), 2 * len(view) * point.iterations, point.iterations)
        resolution, selection = self._choose(frame, point, work)
        self._last.fill(0.0)
        self._last[0, view.ids] = resolution
        self._last[1, view.ids] = point.bound_multiplier
        self._budget_multiplier = point.budget_multiplier
        return selection

    def _build(self, places: int) -> ConvexProgram:
        cost = _SCENE_COST if self.cost is None else self.cost
        return ConvexProgram(self.degradation, cost, _NAMES, places, self.max_iterations)

    def _frame(self, view: View) -> "_Frame":
        """Return what is to be solved; places double when they run out, so few programs are built.

        Raises `InputError` if a formula has no finite value at the lowest resolutions.
        """
        costs, program = self._costs, self._program
        if program.places < len(view):
            self._program = program = self._build(1 << (len(view) - 1).bit_length())
        fixed_ms, _, slope_ms, low = costs.stretches(view)
        values = np.column_stack(
            (
                view.area_px,
                self._costs.primitives(view),
                view.scene.importance[view.ids],
                view.speed_deg_s,
                view.eccentricity_deg,
                view.distance_m,
                fixed_ms,
                slope_ms,
            )
        )
        results = program.evaluate(low, values)
        for what, each in zip(("degradation", "cost"), results, strict=True):
            if not np.isfinite(each).all():
                at = int(np.argmin(np.isfinite(each)))
                pairs = zip(("r", *_NAMES), (low[at], *values[at]), strict=True)
                raise InputError(
                    f"gobbetti-custom: {what}: expected finite values, got {each[at]:g} for node "
                    f"{view.ids[at]} with {', '.join(f'{name} {value:g}' for name, value in pairs)}"
                )
        left_ms = self._budget_ms - costs.fixed_ms(view)
        return _Frame(view, program, values, low, left_ms, float(results[1].sum()) <= left_ms)

    def _solve(self, frame: "_Frame") -> Point:
        """Return the solver's point; nothing solved where the lowest resolutions do not fit."""
        ids, low = frame.view.ids, frame.low
        if not frame.fits_low:
            return Point(low, np.zeros(len(low)), 0.0)
        last, bound_multiplier = self._last[:, ids]
        known = last > 0.0
        start = np.where(known, np.clip(last, low, 1.0), 0.5 * (low + 1.0))
        warm = bool(self._budget_multiplier > 0.0 and known.any())
        begin = Point(start, bound_multiplier, self._budget_multiplier)
        budget_ms = frame.left_ms * (1.0 - _KEPT_BACK)
        return frame.program.solve(frame.values, low, budget_ms, begin, warm=warm)

    def _choose(self, frame: "_Frame", point: Point, work: Work) -> tuple[FloatArray, Selection]:
        """Return the solver's point if it is an optimum that fits, else what is known to fit."""
        attempts = self._attempts(frame, point)
        resolution = next(attempts)
        selection = first = self._selection(frame, resolution, work)
        for following in attempts:
            if selection.predicted_ms <= self._budget_ms:
                break
            resolution, selection = following, self._selection(frame, following, work)
        if frame.fits_low and (selection is not first or point.failure is not None):
            self._note_failure(frame.view, point)
        return resolution, selection

    def _attempts(self, frame: "_Frame", point: Point) -> Iterator[FloatArray]:
        if point.failure is None:
            yield np.minimum(point.resolution * (1.0 + _INTERIOR), 1.0)
        yield np.clip(self._last[0, frame.view.ids], frame.low, 1.0)
        yield frame.low
        yield self._costs.lowest(frame.view)

    def _selection(self, frame: "_Frame", resolution: FloatArray, work: Work) -> Selection:
        costs, view = self._costs, frame.view
        detail = costs.detail(view, resolution)
        if self.cost is None:
            predicted_ms = costs.predict_ms(view, detail)
        else:
            drawn = np.maximum(costs.resolution(view, detail), frame.low)
            spent_ms = frame.program.evaluate(drawn, frame.values)[1]
            predicted_ms = costs.fixed_ms(view) + float(spent_ms.sum())
        return Selection(view.ids, detail, work, predicted_ms=predicted_ms)

    def _note_failure(self, view: View, point: Point) -> None:
        self.failures += 1
        if self.failures == 1:
            why = point.failure or "an optimum that exceeds the budget"
            _log.warning(
                "gobbetti-custom: frame %d: ipopt gave %s; older or the lowest resolutions are "
                "drawn, now and whenever this happens again",
                view.frame,
                why,
            )


@dataclass(frozen=True, slots=True)
class _Frame:
    """One frame's program: values of each object, lowest useful resolutions, and budget left."""

    view: View
    program: ConvexProgram
    values: FloatArray
    low: FloatArray
    left_ms: float
    fits_low: bool
