"""How a machine's costs differ from one occasion, and from one scene, to another."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ...base.errors import InputError
from ...base.predictors import GPU_PREDICTORS

SCATTERED = ("base", *GPU_PREDICTORS)
"""Terms that may differ from scene to scene."""


@dataclass(frozen=True, slots=True)
class Scatter:
    """Spread of GPU times that no posterior of one recording of one scene knows of.

    Attributes
    ----------
    occasion : float
        Standard deviation of the logarithm of a factor of all GPU times, from one occasion of
        recording to another.
    scenes : mapping of str to float
        That of a factor of each term (``base``, or a GPU predictor: its linear, roofline and knee
        coefficients), from scene to scene.
    assumed : bool
        Whether these were not estimated from several occasions and scenes.
    """

    occasion: float = 0.0
    scenes: Mapping[str, float] = field(default_factory=dict[str, float])
    assumed: bool = False

    def __post_init__(self) -> None:
        unknown = sorted(set(self.scenes) - set(SCATTERED))
        if unknown:
            known = ", ".join(SCATTERED)
            raise InputError(f"scatter: expected terms among {known}; got {unknown[0]}")
        for name, sd in (("occasion", self.occasion), *self.scenes.items()):
            # exp(3) is twenty times dearer: a larger spread is a percentage that lost its point.
            if not (np.isfinite(sd) and 0.0 <= sd <= 3.0):
                raise InputError(f"scatter {name}: expected a log-sd from 0 to 3, got {sd}")

    @property
    def any(self) -> bool:
        """Whether any factor differs from 1."""
        return self.occasion > 0.0 or any(sd > 0.0 for sd in self.scenes.values())
