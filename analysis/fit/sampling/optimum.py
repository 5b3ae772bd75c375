"""Where sampling starts: the robust non-negative optimum, polished, and its surroundings."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ....base.arrays import FloatArray
from ..design import Design
from .likelihood import Expansion, Likelihood, QuadraticLikelihood
from .posterior import LogPosterior
from .robust_fit import robust_nnls

LogDensity = Callable[[FloatArray], FloatArray]

_START_DOF = 4.0
_LEAST = 0.02  # size of a parameter that is 0, of the largest one's
_FAR = 10.0  # below the optimum's log density, from where a walker might take long to come back
_ROUNDS = 2  # an expansion at the optimum of the one before has little left to move


def starts(design: Design, time_ms: FloatArray, likelihood: Likelihood) -> list[FloatArray]:
    """Return parameters from robust non-negative least squares, (D,) each.

    With a roofline there are three: both sides, and each side alone, since which side is the larger
    one makes hills of their own.
    """
    robust = robust_nnls(design.columns[1:].T, time_ms, dof=_START_DOF)
    scaled = np.array([robust.base_ms, *robust.slopes_ms])
    noise = np.array([np.log(robust.scale * time_ms.mean()), 0.5, 1.0 / _START_DOF])
    noise = noise[: len(likelihood.names) - len(scaled)]
    if design.linear:
        return [np.concatenate([scaled, noise])]
    sides = scaled[design.additive :].sum()
    given: list[FloatArray] = []
    for geometry, pixels in ((1.0, 1.0), (1.0, 0.1), (0.1, 1.0)):
        one = scaled.copy()
        one[design.additive : -1] = geometry * sides / (len(scaled) - design.additive - 1)
        one[-1] = pixels * sides
        given.append(np.concatenate([one, noise]))
    return given


def highest(posterior: LogPosterior, given: list[FloatArray]) -> FloatArray:
    """Return where a log-posterior is highest, starting from each of the given points, (D,)."""
    return highest_of(posterior, posterior.likelihood.low, posterior.likelihood.high, given)


def highest_of(
    density: LogDensity, low: FloatArray, high: FloatArray, given: list[FloatArray]
) -> FloatArray:
    """Return where a log density is highest within bounds, from each of the given points, (D,)."""
    from scipy.optimize import minimize

    best, best_value = given[0], -np.inf
    for start in given:
        size = np.maximum(np.abs(start), _LEAST * np.abs(start).max())

        def loss(point: FloatArray, size: FloatArray = size) -> float:
            return -float(density((point * size)[np.newaxis])[0])

        bounds: Any = np.stack([low / size, high / size], axis=1)
        answer: Any = minimize(loss, start / size, method="SLSQP", bounds=bounds)
        if -answer.fun > best_value:
            best, best_value = np.asarray(answer.x, dtype=np.float64) * size, -float(answer.fun)
    return best


def expand(density: LogDensity, center: FloatArray, low: FloatArray, high: FloatArray) -> Expansion:
    """Return a log density to second order, by central differences of about a deviation.

    Near a bound the centre moves inside by a step.
    """
    size = np.maximum(np.abs(center), 1e-3 * np.abs(center).max())
    step = np.minimum(1e-3 * size, 0.1 * (high - low))
    middle, value, up, down = _along_axes(density, center, step, low, high)
    curvature = np.maximum(2.0 * value - up - down, 0.0) / step**2
    slope = (up - down) / (2.0 * step)
    step = np.minimum(1.0 / np.sqrt(curvature + slope**2 + 1e-300), 100.0 * size)
    step = np.minimum(step, 0.1 * (high - low))
    middle, value, up, down = _along_axes(density, center, step, low, high)
    sums: FloatArray = up + down - 2.0 * value
    i, j = np.triu_indices(len(center), 1)
    axes = np.diag(step)
    both: FloatArray = axes[i] + axes[j]
    plus, minus = density(np.vstack([middle + both, middle - both])).reshape(2, -1)
    hessian: FloatArray = np.diag(sums / step**2)
    cross: FloatArray = plus + minus - 2.0 * value - sums[i] - sums[j]
    hessian[i, j] = hessian[j, i] = cross / (2.0 * step[i] * step[j])
    return Expansion(middle, value, (up - down) / (2.0 * step), hessian)


def _along_axes(
    density: LogDensity, center: FloatArray, step: FloatArray, low: FloatArray, high: FloatArray
) -> tuple[FloatArray, float, FloatArray, FloatArray]:
    """Return a point inside the bounds, and a density there and a step along each axis."""
    middle = np.clip(center, low + 1.01 * step, high - 1.01 * step)
    axes = np.diag(step)
    values = density(np.vstack([middle, middle + axes, middle - axes]))
    width = len(center)
    return middle, float(values[0]), values[1 : width + 1], values[width + 1 :]


def quadratic(posterior: LogPosterior, start: FloatArray) -> LogPosterior:
    """Return the posterior with its likelihood to second order about its own optimum."""
    whole = posterior.likelihood
    center, result = start, posterior
    for _ in range(_ROUNDS):
        about = expand(whole, center, whole.low, whole.high)
        surrogate = QuadraticLikelihood(whole.names, whole.low, whole.high, about)
        result = LogPosterior(surrogate, posterior.priors)
        center = highest(result, [center])
    return result


def walkers_around(
    posterior: LogPosterior, center: FloatArray, count: int, rng: np.random.Generator
) -> FloatArray:
    """Return starting points scattered like the posterior about its optimum, (count, D).

    The gradient adds to the precision where the optimum lies on a bound: the density falls off
    from there over 1/|gradient|.  Nor is any direction wider than its bounds, or the mean time.
    Points far down the slope are drawn again, nearer.
    """
    low, high = posterior.likelihood.low, posterior.likelihood.high
    about = expand(posterior, center, low, high)
    least = 1.0 / np.where(np.isfinite(high - low), high - low, posterior.priors.mean_ms) ** 2
    precision = np.outer(about.gradient, about.gradient) - about.hessian
    values, vectors = np.linalg.eigh(precision + np.diag(least))
    spread = 1.0 / np.sqrt(np.maximum(values, least.min()))
    enough = posterior(about.center[np.newaxis])[0] - _FAR - len(center)
    kept = np.empty((0, len(center)))
    while len(kept) < count:
        away = rng.standard_normal((count, len(center))) * spread
        points = about.center + away @ vectors.T
        points = np.where(points < low, 2.0 * low - points, points)
        points = np.where(points > high, 2.0 * high - points, points)
        kept = np.vstack([kept, points[posterior(points) > enough]])
        spread *= 0.7
    return kept[:count]
