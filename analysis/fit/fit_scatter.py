"""What a fit knows of other occasions and scenes, and of its own terms."""

import numpy as np

from ...models.machine.identification import Identification
from ...models.machine.scatter import Scatter
from .fit import Fit
from .rounding import to_digits
from .sampling.between_logs import (
    ENOUGH_SCENES,
    OCCASION,
    OCCASION_SCALE,
    SCENE,
    SCENE_SCALE,
    SCENE_TERMS,
)


def scatter_of(fit: Fit) -> Scatter:
    """Return the spread between occasions and scenes: as estimated, or as the priors assume it."""
    chain, sample = fit.estimate.chain, fit.estimate.sample
    origins = [sample.origin(place) for place in range(len(fit.sources))]
    found = {
        name: to_digits(float(chain.flat[:, chain.names.index(name)].mean()))
        for name in chain.names
        if name == OCCASION or name.startswith(SCENE)
    }
    scenes = {
        name: found.get(SCENE + name, SCENE_SCALE)
        for name in SCENE_TERMS
        if name in fit.estimate.design.names
    }
    known = OCCASION in found and len({origin.scene for origin in origins}) >= ENOUGH_SCENES
    return Scatter(found.get(OCCASION, OCCASION_SCALE), scenes, not known)


def variance_share(fit: Fit) -> dict[str, float]:
    """Return the share of the variance of fitted times that is each term's; they sum to 1."""
    estimate = fit.estimate
    width = len(estimate.design.names)
    scaled = estimate.chain.flat[:, :width].mean(axis=0)
    parts = estimate.design.slopes(scaled) * scaled[:, np.newaxis]
    parts -= parts.mean(axis=1, keepdims=True)
    whole = parts.sum(axis=0)
    shares = parts @ whole / float(whole @ whole)
    return {
        name: to_digits(float(share))
        for name, share in zip(estimate.design.names[1:], shares[1:], strict=True)
    }


def identification_of(fit: Fit) -> Identification:
    """Return how well the terms of a fit are told apart."""
    return Identification(
        to_digits(max(fit.collinearity.condition_number, 1.0)), variance_share(fit)
    )
