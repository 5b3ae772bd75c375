"""What is left of a lead once it is remembered that the leader was chosen for it.

The best of many equal policies looks better than it is.  The policies near the best are taken as
drawn from one normal population, whose spread is unknown: where the means differ no more than the
paths' noise would make them, they are drawn together, and where they differ much, they are left as
they are.  Policies far behind have no say in it, so that bad ones do not make a small lead large.
"""

import numpy as np

from ...base.arrays import FloatArray

_FAR = 4.0  # standard errors behind the best from which a policy takes no part
_SPREADS = np.tan(np.pi / 2 * (np.arange(64) + 0.5) / 64)  # half-Cauchy quantiles


def shrink(sampled: FloatArray, values: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return draws of the means, (R, P), from the posterior with that population as the prior.

    Each draw takes a spread of the population from its posterior under a half-Cauchy prior, whose
    scale is the noise of the means: half of it says that differences are below what is seen.

    Source: Efron and Morris, JASA 70 (1975); the prior is Gelman's, Bayesian Analysis 1 (2006).

    Parameters
    ----------
    sampled : (R, P) float64
        Draws under a flat prior.
    values : (P, n) float64
        What they were drawn from, less is better; n is at least 2.
    """
    n = values.shape[1]
    mean = values.mean(axis=1)
    behind = values - values[mean.argmin()]
    error = behind.std(axis=1, ddof=1) / np.sqrt(n)
    near = np.flatnonzero(behind.mean(axis=1) <= _FAR * error)
    if len(near) < 2:
        return sampled
    common = values[near].mean(axis=0)
    variance = (values[near] - common).var(axis=1, ddof=1) / n * (len(near) / (len(near) - 1))
    if not variance.all():
        return sampled
    total = variance + variance.mean() * _SPREADS[:, None] ** 2  # (spreads, near)
    centre = common.mean()
    likelihood = -0.5 * (np.log(total) + (mean[near] - centre) ** 2 / total).sum(axis=1)
    # The centre is estimated from the same means, which costs one of them.
    likelihood += 0.5 * np.log(total.mean(axis=1))
    weight = np.exp(likelihood - likelihood.max())
    chosen = rng.choice(len(weight), len(sampled), p=weight / weight.sum())
    kept = 1 - (variance / total)[chosen]  # (R, near)
    of_draw = sampled[:, near].mean(axis=1, keepdims=True)
    noise = sampled[:, near] - of_draw - (mean[near] - centre)
    result = sampled.copy()
    result[:, near] = of_draw + kept * (mean[near] - centre) + np.sqrt(kept) * noise
    return result
