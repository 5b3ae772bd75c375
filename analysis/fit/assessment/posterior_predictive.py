"""Times that a fitted model predicts: of other frames, and of the same ones as a check."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from ..design import Design
from ..sampling.between_logs import OCCASION, SCENE

_MOST_ROWS = 20_000
_MOST_NUMBERS = 4_000_000  # simulated at a time


@dataclass(frozen=True, slots=True, eq=False)
class Draws:
    """Posterior samples as parameters of times.

    Attributes
    ----------
    names : names of D parameters
    theta : (S, D) float64
    reference_ms : time at which the noise's scale is stated
    """

    names: tuple[str, ...]
    theta: FloatArray
    reference_ms: float

    def moments(self, design: Design) -> tuple[FloatArray, FloatArray]:
        """Return means and scales of the times, (S, n) each, ms."""
        width = len(design.names)
        mean = design.mean(self.theta[:, :width])
        scale = np.exp(self.theta[:, width])[:, np.newaxis]
        if "growth" in self.names:
            growth = self.theta[:, self.names.index("growth")][:, np.newaxis]
            return mean, scale * (1.0 - growth + growth * mean / self.reference_ms)
        return mean, np.broadcast_to(scale, mean.shape)

    @property
    def dof(self) -> FloatArray:
        """Degrees of freedom of each sample, (S,); infinite where the noise is Gaussian."""
        if "inverse_dof" not in self.names:
            return np.full(len(self.theta), np.inf)
        return 1.0 / self.theta[:, self.names.index("inverse_dof")]

    def simulate(self, design: Design, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Return mean times and times drawn with noise, (S, n) each."""
        mean, scale = self.moments(design)
        if "inverse_dof" in self.names:
            noise = rng.standard_t(self.dof[:, np.newaxis], size=mean.shape)
        else:
            noise = rng.standard_normal(mean.shape)
        return mean, mean + scale * noise

    def log_density(self, design: Design, time_ms: FloatArray) -> FloatArray:
        """Return the log of the mean density of each measured time, (n,)."""
        from scipy.special import logsumexp

        density = self.each_log_density(design, time_ms)
        return np.asarray(logsumexp(density, axis=0) - np.log(len(density)))

    def each_log_density(self, design: Design, time_ms: FloatArray) -> FloatArray:
        """Return the log density that each sample gives each measured time, (S, n)."""
        from scipy import stats

        mean, scale = self.moments(design)
        dof = np.minimum(self.dof, 1e9)[:, np.newaxis]
        density: FloatArray = stats.t.logpdf((time_ms - mean) / scale, dof) - np.log(scale)
        return density

    def elsewhere(self, rng: np.random.Generator) -> "Draws":
        """Return samples each on an occasion and in a scene of its own, where these scatter."""
        theta = self.theta.copy()
        for place, name in enumerate(self.names):
            if name == OCCASION:
                moved = slice(0, self.names.index("log_scale"))
            elif name.startswith(SCENE):
                moved = slice(at := self.names.index(name.removeprefix(SCENE)), at + 1)
            else:
                continue
            factor: FloatArray = np.exp(theta[:, place] * rng.standard_normal(len(theta)))
            theta[:, moved] *= factor[:, np.newaxis]
        return Draws(self.names, theta, self.reference_ms)

    def fitting(self, rows: int) -> "Draws":
        """Return as many samples, evenly spaced, as can be simulated over so many rows at once."""
        step = -(-len(self.theta) * rows // _MOST_NUMBERS)
        return Draws(self.names, self.theta[:: max(step, 1)], self.reference_ms)


@dataclass(frozen=True, slots=True)
class Check:
    """A statistic of the measured times beside the same of simulated ones.

    `p` is the share of simulated logs whose statistic is larger; near 0 or 1 the model does not
    make such logs.
    """

    statistic: str
    measured: float
    simulated: float
    p: float


def check_predictive(
    draws: Draws, design: Design, time_ms: FloatArray, rng: np.random.Generator
) -> tuple[Check, ...]:
    """Return posterior predictive checks of spread, tails, skewness and order in time.

    Of a long log, the first `_MOST_ROWS` frames are looked at.
    """
    design, time_ms = design.rows(np.arange(len(time_ms))[:_MOST_ROWS]), time_ms[:_MOST_ROWS]
    draws = draws.fitting(len(time_ms))
    mean, simulated = draws.simulate(design, rng)
    _, scale = draws.moments(design)
    center, width = mean.mean(axis=0), scale.mean(axis=0)
    measured = _statistics(((time_ms - center) / width)[np.newaxis])
    replicated = _statistics((simulated - mean) / scale)
    return tuple(
        Check(
            name,
            float(measured[name][0]),
            float(np.median(replicated[name])),
            float(np.mean(replicated[name] > measured[name])),
        )
        for name in measured
    )


def _statistics(z: FloatArray) -> dict[str, FloatArray]:
    """Return statistics of residuals over their scale, (S, n) to (S,) each."""
    q05, q25, q50, q75, q95 = np.quantile(z, (0.05, 0.25, 0.5, 0.75, 0.95), axis=1)
    away = z - z.mean(axis=1, keepdims=True)
    neighbours = np.einsum("sn,sn->s", away[:, 1:], away[:, :-1])
    return {
        "spread (q75 - q25)": q75 - q25,
        "tails ((q95 - q05) / (q75 - q25))": (q95 - q05) / (q75 - q25),
        "skewness ((q95 + q05 - 2 q50) / (q95 - q05))": (q95 + q05 - 2.0 * q50) / (q95 - q05),
        "largest |residual|": np.abs(z).max(axis=1),
        "correlation of successive frames": neighbours / np.einsum("sn,sn->s", away, away),
    }
