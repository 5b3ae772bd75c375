"""Several logs: what each says of the coefficients, and how these differ between the logs.

On each occasion of recording all times have a common factor, and in each scene some terms have one
of their own: they are log-normal about what the machine costs on average.  A log by itself leaves
behind where the coefficients are and how surely (`dependence`), as a normal distribution; the
factors, to first order, are integrated out, so that only their spreads are sampled, however many
logs there are.  The spreads' priors are half-t (Gelman, Bayesian Analysis 1, 2006).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from ..fit_frames import Origin
from .likelihood import Likelihood

OCCASION, SCENE = "occasion_sd", "scene_sd."
OCCASION_SCALE, SCENE_SCALE = 0.09, 0.25
"""Prior scales of the log-sd: five sessions of llvmpipe differed by 9 %; scenes' is assumed."""

SCENE_TERMS = ("base", "vertices", "triangles", "triangles_in_view", "rasterized_triangles")
"""Terms whose cost differs from scene to scene: of the others too little is known."""

ENOUGH_SCENES = 3
"""Scenes from which their spread is an estimate and not the prior's."""

_DOF = 4.0
_LEAST, _MOST = 1e-3, 1.0


@dataclass(frozen=True, slots=True, eq=False)
class LogSummary:
    """What one log says: ``rows @ coefficients`` is `values` but for independent unit noise.

    Attributes
    ----------
    rows : (k, K) float64
    values : (k,) float64
    origin : scene and occasion
    """

    rows: FloatArray
    values: FloatArray
    origin: Origin


@dataclass(frozen=True, slots=True)
class Levels:
    """Which spreads several logs hold."""

    occasions: tuple[str, ...]
    scenes: tuple[str, ...]
    scene_terms: tuple[str, ...]

    @classmethod
    def of(cls, origins: Sequence[Origin], terms: Sequence[str]) -> "Levels":
        """Return the levels of logs: those of which there are two or more."""
        occasions = tuple(dict.fromkeys(origin.occasion for origin in origins))
        scenes = tuple(dict.fromkeys(origin.scene for origin in origins))
        some = len(scenes) > 1
        scattered = tuple(name for name in SCENE_TERMS if some and name in terms)
        return cls(occasions if len(occasions) > 1 else (), scenes if some else (), scattered)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the spreads, which follow the other parameters."""
        of_scenes = [SCENE + name for name in self.scene_terms]
        return (*([OCCASION] if self.occasions else []), *of_scenes)

    def __bool__(self) -> bool:
        return bool(self.names)


class BetweenLogs:
    """Log-likelihood of K coefficients, the noise of frames, and the spreads between logs."""

    def __init__(
        self,
        logs: Sequence[LogSummary],
        levels: Levels,
        names: Sequence[str],
        pooled: FloatArray,
        noise: Likelihood,
        worth: float,
    ) -> None:
        """Keep the logs' summaries.

        Parameters
        ----------
        names, pooled
            Of the coefficients, and roughly what they are, (K,): what a factor moves them by.
        noise
            Of frames about the mean of their log.
        worth
            Share of a frame that a frame counts for in the noise.
        """
        width, spreads = len(names), len(levels.names)
        self.names = (*names, *noise.names, *levels.names)
        self.low = np.concatenate([np.zeros(width), noise.low, np.full(spreads, _LEAST)])
        self.high = np.concatenate([np.full(width, np.inf), noise.high, np.full(spreads, _MOST)])
        self._noise, self.worth, self._width, self._spreads = noise, worth, width, spreads
        self._rows = np.vstack([log.rows for log in logs])
        self._values = np.concatenate([log.values for log in logs])
        effects, self._spread_of = _effects(logs, levels, names)
        # How values move with each factor, (N, E).  Of the pooled coefficients: with those at hand,
        # ever larger coefficients and spreads would explain each other.
        self._moves: FloatArray = np.einsum("ekn,k->ne", effects, pooled)
        self._inner = self._moves.T @ self._moves

    def __call__(self, theta: FloatArray) -> FloatArray:
        """Return the log-likelihood of (W, D) parameters inside the bounds, (W,)."""
        scaled, spread = theta[:, : self._width], theta[:, len(self.names) - self._spreads :]
        noise = theta[:, self._width : len(self.names) - self._spreads]
        of_noise = self._noise(noise)
        priors = -0.5 * (_DOF + 1.0) * np.log1p((spread / self._scales()) ** 2 / _DOF)
        return self.worth * of_noise + priors.sum(axis=1) + self._of_logs(scaled, spread)

    def _scales(self) -> FloatArray:
        names = self.names[len(self.names) - self._spreads :]
        return np.array([OCCASION_SCALE if name == OCCASION else SCENE_SCALE for name in names])

    def _of_logs(self, scaled: FloatArray, spread: FloatArray) -> FloatArray:
        """Return the log density of all logs' values, their factors integrated out, (W,)."""
        # Cov = 1 + A Aᵀ, a column of A for each factor, by Woodbury's identity.
        each = spread[:, self._spread_of]
        inner = each[:, :, None] * self._inner * each[:, None, :] + np.eye(each.shape[1])
        away = self._values - scaled @ self._rows.T
        along = each * (away @ self._moves)
        explained = np.einsum("we,we->w", along, np.linalg.solve(inner, along[..., None])[..., 0])
        squares = np.einsum("wn,wn->w", away, away) - explained
        return -0.5 * (squares + np.linalg.slogdet(inner)[1])


def _effects(
    logs: Sequence[LogSummary], levels: Levels, names: Sequence[str]
) -> tuple[FloatArray, np.ndarray[tuple[int], np.dtype[np.int64]]]:
    """Return rows of the coefficients that each of E factors multiplies, and its spread, (E,).

    The first is (E, K, N), nothing in the rows of logs that a factor is not of.
    """
    factors: list[tuple[str, str, slice | int]] = [
        (OCCASION, occasion, slice(None)) for occasion in levels.occasions
    ]
    factors += [
        (SCENE + term, scene, list(names).index(term))
        for term in levels.scene_terms
        for scene in levels.scenes
    ]
    effects = np.zeros((len(factors), len(names), sum(len(log.values) for log in logs)))
    for place, (spread, of, terms) in enumerate(factors):
        start = 0
        for log in logs:
            stop = start + len(log.values)
            origin = log.origin.occasion if spread == OCCASION else log.origin.scene
            if origin == of:
                effects[place, terms, start:stop] = log.rows.T[terms]
            start = stop
    which = [list(levels.names).index(spread) for spread, _, _ in factors]
    return effects, np.array(which, dtype=np.int64)
