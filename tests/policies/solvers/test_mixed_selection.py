"""Increments and smooth variables in turn, compared with every front with its best shares."""

import itertools
from typing import Any

import casadi
import numpy as np
import pytest

from lodbench.policies.solvers.allocation import allocate
from lodbench.policies.solvers.increment_forest import IncrementForest
from lodbench.policies.solvers.mixed_selection import raise_in_turn
from lodbench.policies.solvers.smooth_ascent import Ascent, GradientAscent, NewtonAscent

ENGINES = ("bent", "gradient", "newton")
ROWS, COLUMNS, SMOOTH = 4, 2, 5


class Instance:
    """Four chains of two increments with falling slopes, two below two; five smooth variables."""

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.cost = rng.uniform(0.1, 1.0, (ROWS, COLUMNS))
        slope = rng.uniform(0.5, 4.0, (2, 1)) * np.array([[1.0, 0.6]])
        below = slope * rng.uniform(0.1, 0.55, (2, 1))
        self.gain = self.cost * np.concatenate((slope, below))
        self.above = np.array([-1, -1, 0, 1])
        self.weight = rng.uniform(0.3, 3.0, SMOOTH)
        self.high = rng.uniform(0.2, 2.0, SMOOTH)
        self.low = 0.05 * self.high
        self.budget = float(rng.uniform(0.3, 4.0))

    def forest(self) -> IncrementForest:
        """Return its increments."""
        void = np.zeros((ROWS, COLUMNS), dtype=bool)
        return IncrementForest(self.cost, self.gain, void, self.above, np.array([0, 2, 4]))

    def ascent(self, engine: str, barrier: float = 0.0) -> Ascent:
        """Return its smooth variables."""
        if engine == "newton":
            return NewtonAscent(self.weight, self.low, self.high)
        bent = engine == "bent"
        return GradientAscent(self.weight, self.low, self.high, barrier=barrier, bent=bent)

    def benefit(self, taken: Any, x: Any) -> float:
        """Return benefit beyond the start of taken increments and smooth values."""
        more = self.weight @ (np.sqrt(x) - np.sqrt(self.low))
        return float(self.gain[taken].sum()) + float(more)

    def choices(self) -> list[tuple[int, ...]]:
        """Return all numbers of increments taken in each row that respect the rows above."""
        every = itertools.product(range(COLUMNS + 1), repeat=ROWS)
        return [n for n in every if (n[2] == 0 or n[0] == 2) and (n[3] == 0 or n[1] == 2)]

    def best(self) -> float:
        """Return the greatest benefit of any choice with the best shares of what it leaves."""
        best = -np.inf
        for counts in self.choices():
            taken = np.arange(COLUMNS) < np.array(counts)[:, None]
            left = self.budget - float(self.cost[taken].sum())
            if left >= 0.0:
                x = self._shares(left)
                best = max(best, self.benefit(taken, x))
        return best

    def _shares(self, left: float) -> Any:
        budget = left + float(self.low.sum())
        ones = np.ones(SMOOTH)
        half = 0.5 * self.weight
        return allocate(half, ones, budget, power=0.5, low=self.low, high=self.high).x

    def by_ipopt(self, left: float) -> float:
        """Return the greatest smooth benefit within a budget, as ipopt finds it."""
        library: Any = casadi
        x = library.SX.sym("x", SMOOTH)
        problem = {"x": x, "f": -library.dot(self.weight, library.sqrt(x)), "g": library.sum1(x)}
        quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
        solver: Any = library.nlpsol("solver", "ipopt", problem, quiet | {"ipopt.tol": 1e-10})
        limit = left + float(self.low.sum())
        found = solver(x0=0.5 * (self.low + self.high), lbx=self.low, ubx=self.high, ubg=limit)
        return -float(found["f"]) - float(self.weight @ np.sqrt(self.low))


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(12))
def test_only_the_increment_that_did_not_fit_parts_it_from_the_optimum(
    engine: str, seed: int
) -> None:
    """Within the greatest gain of one increment of the best of all choices, each by itself best."""
    given = Instance(seed)
    forest, smooth = given.forest(), given.ascent(engine)
    spent, _ = raise_in_turn(forest, smooth, given.budget, 10_000)
    taken = forest.taken
    total = float(given.cost[taken].sum()) + float((smooth.x - given.low).sum())
    assert spent == pytest.approx(total)
    assert total <= given.budget * (1.0 + 1e-9)
    reached, best = given.benefit(taken, smooth.x), given.best()
    left_out = float(given.gain[~taken].max(initial=0.0))
    assert best * (1.0 + 1e-9) >= reached >= best - left_out - 1e-9
    # The smooth half is the best there is beside the increments taken.
    smooth_best = given.by_ipopt(given.budget - float(given.cost[taken].sum()))
    assert given.benefit(taken & False, smooth.x) == pytest.approx(smooth_best, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("seed", range(12))
def test_engines_agree(seed: int) -> None:
    """Rays, bent rays and the closed form take the same increments and give the same shares."""
    given = Instance(seed)
    ends: list[tuple[Any, Any]] = []
    for engine in ENGINES:
        forest, smooth = given.forest(), given.ascent(engine)
        raise_in_turn(forest, smooth, given.budget, 10_000)
        ends.append((forest.taken, smooth.x))
    for taken, x in ends[1:]:
        assert (taken == ends[0][0]).all()
        assert x == pytest.approx(ends[0][1], rel=1e-6)


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("seed", range(6))
def test_every_step_is_feasible_and_better(engine: str, seed: int) -> None:
    """Stopped after any number of steps, the budget holds and nothing gained is lost again."""
    given = Instance(seed)
    last = 0.0
    for steps in range(12):
        forest, smooth = given.forest(), given.ascent(engine, barrier=1e-2)
        spent, took = raise_in_turn(forest, smooth, given.budget, steps)
        assert took <= steps
        assert spent <= given.budget * (1.0 + 1e-9)
        now = given.benefit(forest.taken, smooth.x)
        assert now >= last - 1e-9
        last = now
    assert last > 0.0


def test_an_increment_goes_before_what_is_worth_less() -> None:
    """One smooth variable of weight 2 (slope 1 / sqrt(x)) and an increment of slope 0.5, cost 1.

    With 6 to spend the variable rises to x = 4, where its slope is 0.5; the increment follows, and
    the last unit lifts the variable to 5.  With 4.5 the increment fits no more after that.
    """
    for budget, taken, x in ((6.0, True, 5.0), (4.5, False, 4.5)):
        forest = IncrementForest(
            np.ones((1, 1)),
            np.array([[0.5]]),
            np.array([[False]]),
            np.array([-1]),
            np.array([0, 1]),
        )
        smooth = GradientAscent(
            np.array([2.0]), np.zeros(1), np.array([100.0]), barrier=0.0, bent=True
        )
        raise_in_turn(forest, smooth, budget, 100)
        assert bool(forest.taken[0, 0]) == taken
        assert smooth.x[0] == pytest.approx(x)
