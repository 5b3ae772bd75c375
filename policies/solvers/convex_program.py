"""A user's cost and degradation as a nonlinear program, solved by casadi's ipopt."""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from .expression import symbolic

_OPTIONS = {
    "print_time": False,
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-9,
    "ipopt.constr_viol_tol": 1e-9,
    "ipopt.bound_relax_factor": 0.0,  # bounds are kept exactly
}
# A warm start keeps close to the bounds that hold already.
_WARM = {"ipopt.warm_start_init_point": "yes", "ipopt.mu_init": 1e-6} | {
    f"ipopt.warm_start_{name}": 1e-8
    for name in (
        "bound_push",
        "bound_frac",
        "slack_bound_push",
        "slack_bound_frac",
        "mult_bound_push",
    )
}


@dataclass(frozen=True, slots=True)
class Point:
    """Where the solver stopped, and what it needs to start there again.

    Attributes
    ----------
    resolution, bound_multiplier : (m,) float64
    budget_multiplier : float
    iterations : int
    failure : str or None
        ipopt's word for why it stopped short of an optimum.
    """

    resolution: FloatArray
    bound_multiplier: FloatArray
    budget_multiplier: float
    iterations: int = 0
    failure: str | None = None


class ConvexProgram:
    """Minimise Σ degradation(r) subject to Σ cost(r) <= budget and low <= r <= 1.

    The formulas are functions of the resolution ``r`` and of named values of each object, and
    casadi derives them.  The program has a fixed number of places; those beyond m objects are
    masked, so that it is not built anew in every frame.
    """

    def __init__(
        self, degradation: str, cost: str, names: tuple[str, ...], places: int, max_iterations: int
    ) -> None:
        import casadi

        library: Any = casadi
        resolution = library.SX.sym("r", places)
        values = library.SX.sym("values", places, len(names) + 1)
        budget = library.SX.sym("budget")
        symbols: dict[str, Any] = {name: values[:, k] for k, name in enumerate(names)}
        symbols["r"] = resolution
        ones = library.SX.ones(places)
        # A formula without names is a constant, a 1 × 1 matrix to casadi: `ones` spreads it.
        loss = ones * symbolic(degradation, symbols, "degradation")
        spent = ones * symbolic(cost, symbols, "cost")
        mask = values[:, len(names)]
        problem = {
            "x": resolution,
            "p": library.veccat(values, budget),
            "f": library.dot(mask, loss),
            # Over the budget, because ipopt's tolerance on constraints is absolute.
            "g": library.dot(mask, spent) / budget,
        }
        options = _OPTIONS | {"ipopt.max_iter": max_iterations}
        self.places = places
        # Two solvers, because ipopt's options are fixed when it is made.
        self._cold: Any = library.nlpsol("cold", "ipopt", problem, options)
        self._warm: Any = library.nlpsol("warm", "ipopt", problem, options | _WARM)
        self._each: Any = library.Function("each", [resolution, values], [loss, spent])

    def evaluate(self, resolution: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return degradation and cost of each object, (m,); `values` is (m, names)."""
        padded = self._padded(resolution, 1.0), self._masked(values)
        loss, spent = (np.asarray(part.full()).ravel() for part in self._each(*padded))
        return loss[: len(resolution)], spent[: len(resolution)]

    def solve(
        self, values: FloatArray, low: FloatArray, budget: float, start: Point, *, warm: bool
    ) -> Point:
        """Return the optimum from `start`; from scratch where a warm start does not reach it."""
        # Spare places have both bounds at 1; ipopt takes such variables out of the problem.
        count = len(low)
        solver = self._warm if warm else self._cold
        found: dict[str, Any] = solver(
            x0=self._padded(start.resolution, 1.0),
            lam_x0=self._padded(start.bound_multiplier, 0.0),
            lam_g0=start.budget_multiplier,
            p=np.append(self._masked(values).ravel(order="F"), budget),
            lbx=self._padded(low, 1.0),
            ubx=1.0,
            lbg=-math.inf,
            ubg=1.0,
        )
        stats: dict[str, Any] = solver.stats()
        if warm and not stats["success"]:
            again = self.solve(values, low, budget, start, warm=False)
            return replace(again, iterations=again.iterations + int(stats["iter_count"]))
        return Point(
            np.asarray(found["x"].full()).ravel()[:count],
            np.asarray(found["lam_x"].full()).ravel()[:count],
            float(found["lam_g"]),
            int(stats["iter_count"]),
            None if stats["success"] else str(stats["return_status"]),
        )

    def _padded(self, values: FloatArray, rest: float) -> FloatArray:
        return np.append(values, np.full(self.places - len(values), rest))

    def _masked(self, values: FloatArray) -> FloatArray:
        """Return values with their mask, the places beyond filled with the first object's."""
        # Not zeros: a formula may divide by any of these values or take its logarithm.
        rest = self.places - len(values)
        full = np.concatenate((values, np.repeat(values[:1], rest, axis=0)))
        mask = np.where(np.arange(self.places) < len(values), 1.0, 0.0)
        return np.column_stack((full, mask))
