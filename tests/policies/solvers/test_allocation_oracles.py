"""Both solvers against two independent ones: a dual bisection, and casadi's ipopt."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi
import numpy as np
import pytest

from lodbench.base.arrays import FloatArray
from lodbench.policies.solvers.active_set import ActiveSet
from lodbench.policies.solvers.allocation import Allocation, Shares, allocate

nlpsol: Any = casadi.nlpsol
dot: Any = casadi.dot
SX: Any = casadi.SX
Solver = Callable[..., Allocation]
Residual = Callable[..., float]


def by_active_set(
    weight: FloatArray,
    cost: FloatArray,
    budget: float,
    *,
    power: float,
    low: FloatArray,
    high: float,
) -> Allocation:
    """Return what the search finds, asked as `allocate` is."""
    shares = Shares(weight, cost, budget, power, low, np.full(len(cost), high))
    return ActiveSet(1_000_000).search(shares)


SOLVERS: dict[str, Solver] = {
    "newton": allocate,
    "active-set": by_active_set,
}


@dataclass(frozen=True)
class Instance:
    """Minimise ``Σ a r^-m`` for ``Σ c r <= budget``, ``low <= r <= 1``."""

    m: int
    a: FloatArray
    cost: FloatArray
    low: FloatArray
    budget: float

    def degradation(self, r: FloatArray) -> float:
        """Return the objective, summed without rounding so that 1e-12 means something."""
        return math.fsum(self.a * r**-self.m)

    def solve(self, solver: Solver) -> Allocation:
        """Return what a solver of ours finds."""
        return solver(
            self.m * self.a, self.cost, self.budget, power=self.m + 1.0, low=self.low, high=1.0
        )

    def residual(self, kkt_residual: Residual, result: Allocation) -> float:
        """Return its violation of the optimality conditions."""
        args: dict[str, Any] = {"power": self.m + 1.0, "low": self.low, "high": 1.0}
        return kkt_residual(result, self.m * self.a, self.cost, self.budget, **args)


def draw(seed: int, largest: int) -> Instance:
    """Draw areas over four decades and triangles over two; m alternates, n has a cap."""
    rng = np.random.default_rng(seed)
    n = 1 + int(largest * rng.random() ** 2)
    area, triangles = np.exp(rng.normal(6.0, 1.5, n)), np.exp(rng.normal(7.0, 1.0, n))
    a = area / triangles if rng.random() < 0.5 else area
    low = rng.uniform(0.01, 0.4, n)
    cost = 5e-6 * triangles
    floor = float(cost @ low)
    budget = floor + rng.uniform(0.02, 0.98) * (float(cost.sum()) - floor)
    return Instance(1 + seed % 2, a, cost, low, budget)


def bisect(instance: Instance) -> FloatArray:
    """Halve an interval of log λ until the cost of ``r(λ)`` meets the budget: nothing shared."""
    power, value = instance.m + 1.0, instance.m * instance.a / instance.cost

    def resolution(log_multiplier: float) -> FloatArray:
        log_r = (np.log(value) - log_multiplier) / power
        return np.clip(np.exp(log_r), instance.low, 1.0)

    few = float(np.log(value).min())
    much = float((np.log(value) - power * np.log(instance.low)).max())
    while (middle := 0.5 * (few + much)) not in {few, much}:
        if float(instance.cost @ resolution(middle)) > instance.budget:
            few = middle
        else:
            much = middle
    return resolution(much)


def ipopt(instance: Instance) -> FloatArray:
    """Return ipopt's solution, scaled to budget 1 and kept within the bounds and the budget."""
    n = len(instance.a)
    r = SX.sym("r", n)
    scale = instance.degradation(np.clip(np.full(n, 0.5), instance.low, 1.0))
    problem = {
        "x": r,
        "f": dot(instance.a / scale, r**-instance.m),
        "g": dot(instance.cost / instance.budget, r),
    }
    options = {"print_level": 0, "sb": "yes", "tol": 1e-10, "bound_relax_factor": 0.0}
    solver = nlpsol("solver", "ipopt", problem, {"print_time": False, "ipopt": options})
    found = solver(x0=0.5 * (instance.low + 1.0), lbx=instance.low, ubx=1.0, ubg=1.0)
    assert solver.stats()["success"]
    return np.asarray(found["x"].full()).ravel()


def hold_against_bisection(
    solver: Solver, seeds: range, largest: int, kkt_residual: Residual
) -> tuple[int, int]:
    """Check a solver on instances; return how many had active lower and upper bounds."""
    at_low = at_high = 0
    for seed in seeds:
        instance = draw(seed, largest)
        result = instance.solve(solver)
        truth = instance.degradation(bisect(instance))
        assert instance.degradation(result.x) == pytest.approx(truth, rel=1e-12), seed
        assert instance.residual(kkt_residual, result) < 1e-9, seed
        at_low += bool((result.x <= instance.low).any())
        at_high += bool((result.x >= 1.0).any())
    return at_low, at_high


def hold_against_ipopt(seeds: range, largest: int) -> None:
    """Check Newton on instances: never above ipopt by 1e-9, and 1e-7 from it."""
    for seed in seeds:
        instance = draw(seed, largest)
        ours = instance.degradation(instance.solve(allocate).x)
        ratio = ours / instance.degradation(ipopt(instance))
        assert 1.0 - 1e-7 <= ratio <= 1.0 + 1e-9, (seed, ratio)


@pytest.mark.parametrize("name", SOLVERS)
def test_objective_equals_a_dual_bisection(name: str, kkt_residual: Residual) -> None:
    """On 150 instances to 1e-12, most of them with active bounds on both sides."""
    at_low, at_high = hold_against_bisection(SOLVERS[name], range(150), 1000, kkt_residual)
    assert min(at_low, at_high) > 75


def test_objective_equals_ipopt() -> None:
    """On 40 instances within ipopt's tolerance, and never worse."""
    hold_against_ipopt(range(40), 500)


@pytest.mark.slow
@pytest.mark.parametrize("name", SOLVERS)
def test_objective_equals_a_dual_bisection_on_a_thousand(name: str, kkt_residual: Residual) -> None:
    """On 1,000 instances of up to 2,000 objects."""
    at_low, at_high = hold_against_bisection(SOLVERS[name], range(1000), 2000, kkt_residual)
    assert min(at_low, at_high) > 500


@pytest.mark.slow
def test_objective_equals_ipopt_on_a_thousand() -> None:
    """On 1,000 instances of up to 2,000 objects."""
    hold_against_ipopt(range(1000), 2000)
