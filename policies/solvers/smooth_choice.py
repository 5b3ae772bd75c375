"""Level selection where some objects take any resolution between their knots: the convex optimum.

An object's alternatives are columns, finest first.  A discrete object takes one of them.  A
continuous one may stand between two neighbouring columns, where cost and samples are linear in the
resolution and benefit is ``weight · (1 - BASE_ERROR / samples)``, concave.  For a price per cost
every object's best response has a closed form; the price at which the responses use the budget up
gives the optimum of the relaxation, and the Lagrangian dual at any price bounds every selection.
"""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ...models.scene.benefit import BASE_ERROR

_HALVINGS = 80  # of the price's logarithm: from 1e±30 down to the last bits of a double


@dataclass(frozen=True, slots=True)
class Response:
    """A selection: columns, the share of the way to the next finer column, and the sums."""

    column: IntArray
    share: FloatArray
    cost: float
    benefit: float


@dataclass(eq=False)
class SmoothChoice:
    """n objects with up to L alternatives.

    Attributes
    ----------
    cost, benefit, samples : (n, L) float64
        Falling along each row; cost infinite where there is no alternative.
    weight : (n,) float64
        Benefit of infinite samples.
    soft : (n,) bool
        Which objects are continuous.
    """

    cost: FloatArray
    benefit: FloatArray
    samples: FloatArray
    weight: FloatArray
    soft: BoolArray

    def __post_init__(self) -> None:
        cost, samples = self.cost, self.samples
        spans = np.isfinite(cost[:, 1:]) & self.soft[:, None]
        width = np.where(spans, samples[:, :-1] - samples[:, 1:], 0.0)
        self._spans = spans & (width > 0.0)
        step = np.zeros_like(width)
        np.subtract(cost[:, :-1], cost[:, 1:], out=step, where=self._spans)
        self._slope = np.divide(step, width, out=np.zeros_like(width), where=self._spans)

    def respond(self, price: float) -> Response:
        """Return the selection that is best when a unit of cost is worth `price` of benefit."""
        rows = np.arange(len(self.weight))
        real = np.isfinite(self.cost)
        value = np.where(real, self.benefit - price * np.where(real, self.cost, 0.0), -np.inf)
        # Of equals argmax takes the first, which is the finest.
        column: IntArray = value.argmax(axis=1)
        share = np.zeros(len(rows))
        if self._spans.any():
            samples, between = self._between(price)
            best: IntArray = between.argmax(axis=1)
            inside = between[rows, best] > value[rows, column]
            low, high = self.samples[rows, best + 1], self.samples[rows, best]
            way = np.divide(
                samples[rows, best] - low, high - low, out=np.zeros(len(rows)), where=high > low
            )
            column = np.where(inside, best + 1, column)
            share = np.where(inside, np.clip(way, 0.0, 1.0), 0.0)
        return self._sums(column, share)

    def _between(self, price: float) -> tuple[FloatArray, FloatArray]:
        """Return, per span, the samples that are best within it and their value."""
        low, high = self.samples[:, 1:], self.samples[:, :-1]
        # Where benefit rises by what it costs: weight · BASE_ERROR / samples² = price · slope.
        # 1e-300 stands for a slope of 0, where the clip takes the finer end.
        rising = np.maximum(price * self._slope, 1e-300)
        best = np.sqrt(BASE_ERROR * self.weight[:, None] / rising)
        best = np.clip(best, low, np.maximum(low, high))
        cost = np.where(self._spans, self.cost[:, 1:], 0.0) + self._slope * (best - low)
        value = self.weight[:, None] * (1.0 - BASE_ERROR / np.maximum(best, 1.0)) - price * cost
        return best, np.where(self._spans, value, -np.inf)

    def _sums(self, column: IntArray, share: FloatArray) -> Response:
        rows = np.arange(len(column))
        finer = np.maximum(column - 1, 0)
        cost, samples = self.cost[rows, column], self.samples[rows, column]
        benefit = self.benefit[rows, column]
        part = share > 0.0
        cost = np.where(part, cost + share * (self.cost[rows, finer] - cost), cost)
        samples = samples + share * (self.samples[rows, finer] - samples)
        smooth = self.weight * (1.0 - BASE_ERROR / np.maximum(samples, 1.0))
        benefit = np.where(part, smooth, benefit)
        return Response(column, share, float(cost.sum()), float(benefit.sum()))

    def within(self, budget: float) -> tuple[Response, float]:
        """Return the best response that fits the budget, and a bound on any selection's benefit.

        If even the coarsest selection does not fit, it is returned, and the bound is minus
        infinity.
        """
        free = self.respond(0.0)
        if free.cost <= budget:
            return free, free.benefit
        coarsest: IntArray = np.isfinite(self.cost).sum(axis=1) - 1
        cheapest = self._sums(coarsest, np.zeros(len(coarsest)))
        if cheapest.cost > budget:
            return cheapest, -np.inf
        # A higher price never buys more, so the side that fits the budget is always `high`.
        low, high = -70.0, 70.0
        found, bound = cheapest, np.inf
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            price = float(np.exp(middle))
            response = self.respond(price)
            # Weak duality: at any price this is at least what a selection within the budget can
            # have, so the least over all prices tried is a bound, converged or not.
            dual = response.benefit - price * (response.cost - budget)
            bound = min(bound, dual)
            if response.cost <= budget:
                found, high = response, middle
            else:
                low = middle
        return found, bound
