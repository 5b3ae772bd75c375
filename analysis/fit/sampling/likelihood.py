"""Log-likelihoods of W parameter vectors at once.

Parameters are the K scaled coefficients, the logarithm of the noise's scale in ms at the mean
time, and for Student's t the share of the scale that grows with the mean and 1/dof.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ....base.arrays import FloatArray
from ..design import Design
from .priors import DOF_HIGH, DOF_LOW

_BLOCK = 20_000  # numbers at a time: 160 kB, so that a block stays in the second-level cache
_FOLD = 8  # factors multiplied before one logarithm; each is under 1e38, or the sum is infinite


class Likelihood(Protocol):
    """A log-likelihood with names of D parameters, and their bounds, (D,) each."""

    names: tuple[str, ...]
    low: FloatArray
    high: FloatArray

    def __call__(self, theta: FloatArray) -> FloatArray:
        """Return the log-likelihood of (W, D) parameters inside the bounds, (W,)."""
        ...


class GaussianLikelihood:
    """Gaussian noise of constant scale.

    Without a roofline the residual sum of squares is that at the least-squares solution plus
    ``|R (c - c0)|²``, R of the design's QR factorisation: sufficient statistics of the log, exact
    whatever its length.
    """

    def __init__(self, design: Design, time_ms: FloatArray) -> None:
        self.design, self.time_ms = design, time_ms
        self.names = (*design.names, "log_scale")
        self.low, self.high = _bounds(design, time_ms)
        columns = design.columns.T
        self._solution = np.linalg.lstsq(columns, time_ms)[0]
        residual = time_ms - columns @ self._solution
        triangle: Any = np.linalg.qr(columns, mode="r")
        self._triangle = np.ascontiguousarray(triangle.T, dtype=np.float64)
        self._least = float(residual @ residual)

    def __call__(self, theta: FloatArray) -> FloatArray:
        """Return the log-likelihood of (W, D) parameters inside the bounds, (W,)."""
        scaled, log_scale = theta[:, :-1], theta[:, -1]
        if self.design.linear:
            away = (scaled - self._solution) @ self._triangle
            squares = self._least + np.einsum("wk,wk->w", away, away)
        else:
            squares = _by_blocks(self._squares, scaled, len(self.time_ms))
        rows = len(self.time_ms)
        constant = 0.5 * rows * np.log(2.0 * np.pi)
        return -0.5 * squares * np.exp(-2.0 * log_scale) - rows * log_scale - constant

    def _squares(self, scaled: FloatArray) -> FloatArray:
        residual = self.time_ms - self.design.mean(scaled)
        return np.einsum("wn,wn->w", residual, residual)


class StudentLikelihood:
    """Student's t of scale ``s · (1 - g + g · mean / reference)``.

    s is the scale at the reference, the mean time of the log; g the share of the scale that grows
    with the mean; all of s, g and the degrees of freedom are parameters.
    """

    def __init__(self, design: Design, time_ms: FloatArray, reference_ms: float) -> None:
        self.design, self.time_ms, self.reference_ms = design, time_ms, reference_ms
        self.names = (*design.names, "log_scale", "growth", "inverse_dof")
        self.low, self.high = _bounds(design, time_ms, (0.0, 1.0), (1.0 / DOF_HIGH, 1.0 / DOF_LOW))

    def __call__(self, theta: FloatArray) -> FloatArray:
        """Return the log-likelihood of (W, D) parameters inside the bounds, (W,)."""
        from scipy.special import gammaln

        log_scale, inverse = theta[:, -3], theta[:, -1]
        dof = 1.0 / inverse
        each = gammaln(0.5 * dof + 0.5) - gammaln(0.5 * dof) - 0.5 * np.log(np.pi * dof)
        rows = len(self.time_ms)
        return rows * (each - log_scale) - _by_blocks(self._rows, theta, rows)

    def _rows(self, theta: FloatArray) -> FloatArray:
        """Return the part of the negative log-likelihood that differs from frame to frame, (W,)."""
        growth, inverse = theta[:, -2], theta[:, -1]
        mean = self.design.mean(theta[:, :-3])
        scale = mean * (growth / self.reference_ms)[:, np.newaxis]
        scale += (1.0 - growth)[:, np.newaxis]
        ratio = np.subtract(self.time_ms, mean, out=mean)
        ratio /= scale
        np.multiply(ratio, ratio, out=ratio)
        ratio *= (inverse * np.exp(-2.0 * theta[:, -3]))[:, np.newaxis]
        ratio += 1.0
        return _sum_of_logs(scale) + (0.5 / inverse + 0.5) * _sum_of_logs(ratio)


def _bounds(
    design: Design, time_ms: FloatArray, *others: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Return bounds of coefficients, of the log of a scale that fits any log, and of `others`."""
    mean = float(time_ms.mean())
    scale = (float(np.log(1e-9 * mean)), float(np.log(1e3 * mean)))
    low, high = np.array([*[(0.0, np.inf)] * len(design.names), scale, *others]).T
    return low, high


def _by_blocks(
    rows: Callable[[FloatArray], FloatArray], theta: FloatArray, count: int
) -> FloatArray:
    """Return a function of (W, D) parameters that visits `count` frames, some vectors at a time."""
    step = max(1, _BLOCK // count)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        parts = [rows(theta[start : start + step]) for start in range(0, len(theta), step)]
    total = np.concatenate(parts)
    return np.where(np.isnan(total), np.inf, total)


def _sum_of_logs(values: FloatArray) -> FloatArray:
    """Return the sum of logarithms along rows, (W, n) to (W,); one logarithm for eight values."""
    fold = values.shape[1] // _FOLD
    head = values[:, : _FOLD * fold].reshape(len(values), _FOLD, fold)
    products: FloatArray = np.multiply.reduce(head, axis=1)
    return np.log(products).sum(axis=1) + np.log(values[:, _FOLD * fold :]).sum(axis=1)


@dataclass(frozen=True, slots=True, eq=False)
class Expansion:
    """A function to second order about `center`."""

    center: FloatArray
    value: float
    gradient: FloatArray
    hessian: FloatArray


@dataclass(slots=True, eq=False)
class QuadraticLikelihood:
    """A log-likelihood to second order about a point: what all frames of a long log leave behind.

    With many frames the posterior is so narrow that nothing of third order is left in it.
    """

    names: tuple[str, ...]
    low: FloatArray
    high: FloatArray
    about: Expansion

    def __call__(self, theta: FloatArray) -> FloatArray:
        """Return the log-likelihood of (W, D) parameters inside the bounds, (W,)."""
        away = theta - self.about.center
        curved = np.einsum("wi,ij,wj->w", away, self.about.hessian, away)
        return self.about.value + away @ self.about.gradient + 0.5 * curved
