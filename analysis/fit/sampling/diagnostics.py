"""Whether a chain can be trusted."""

from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from .sampler import LONG_ENOUGH, Chain

_GROUPS = 4
_MIXED = 1.05


@dataclass(frozen=True, slots=True)
class Diagnostics:
    """Figures of a chain; the worst over all parameters, and each parameter's own.

    Attributes
    ----------
    acceptance : share of proposals accepted
    autocorr_time : steps
    ess : effective number of independent samples
    r_hat : split R-hat over groups of walkers
    steps, walkers : of the chain without burn-in
    lengths : chain length in autocorrelation times
    by_parameter : name to autocorrelation time, ess and R-hat
    """

    acceptance: float
    autocorr_time: float
    ess: float
    r_hat: float
    steps: int
    walkers: int
    lengths: float
    by_parameter: dict[str, dict[str, float]]

    @property
    def doubt(self) -> str:
        """Why the chain is not to be trusted, in words; empty where it is."""
        if self.lengths < LONG_ENOUGH:
            return (
                f"the chain has {self.lengths:.1f} autocorrelation times of "
                f"{self.autocorr_time:.0f} steps, fewer than {LONG_ENOUGH:.0f}"
            )
        if self.r_hat > _MIXED:
            return f"groups of walkers disagree, split R-hat {self.r_hat:.3f} is over {_MIXED}"
        return ""


def diagnose(chain: Chain) -> Diagnostics:
    """Return the diagnostics of a chain."""
    steps, walkers, _ = chain.samples.shape
    ess = steps * walkers / chain.tau
    r_hat = split_r_hat(chain.samples)
    return Diagnostics(
        acceptance=chain.acceptance,
        autocorr_time=float(chain.tau.max()),
        ess=float(ess.min()),
        r_hat=float(r_hat.max()),
        steps=steps,
        walkers=walkers,
        lengths=chain.lengths,
        by_parameter={
            name: {"autocorr_time": float(tau), "ess": float(size), "r_hat": float(ratio)}
            for name, tau, size, ratio in zip(chain.names, chain.tau, ess, r_hat, strict=True)
        },
    )


def split_r_hat(samples: FloatArray) -> FloatArray:
    """Return split R-hat of each parameter, (steps, walkers, D) to (D,).

    Walkers of one ensemble move together, so single walkers are no independent chains; groups of
    them, each over the first and the second half of the steps, are compared instead (Gelman et
    al., Bayesian Data Analysis, 3rd ed., section 11.4).
    """
    half = len(samples) // 2
    chains = [
        part[:, group::_GROUPS].reshape(-1, samples.shape[2])
        for part in (samples[:half], samples[half : 2 * half])
        for group in range(_GROUPS)
    ]
    count = min(map(len, chains))
    stacked = np.stack([chain[:count] for chain in chains])
    within: FloatArray = stacked.var(axis=1, ddof=1).mean(axis=0)
    between: FloatArray = stacked.mean(axis=1).var(axis=0, ddof=1)
    return np.sqrt((count - 1) / count + between / within)
