"""A cost that begins where a frame counts more than a machine takes in its stride."""

from dataclasses import dataclass

import numpy as np

from ...base.errors import InputError
from ...base.predictors import GPU_PREDICTORS


@dataclass(frozen=True, slots=True)
class Knee:
    """``ms · max(0, total − at)`` of the frame's total of a predictor, beside its linear price.

    A cache, a bin of a rasteriser or a queue that a frame outgrows makes every further unit dearer.
    It is of the frame as a whole, so that no object has a share of it.

    Attributes
    ----------
    predictor : str
        One of `GPU_PREDICTORS`.
    at : float
        Total up to which it costs nothing, not negative.
    ms : float
        Milliseconds per unit beyond, not negative.
    """

    predictor: str
    at: float
    ms: float

    def __post_init__(self) -> None:
        if self.predictor not in GPU_PREDICTORS:
            known = ", ".join(GPU_PREDICTORS)
            raise InputError(f"knee: expected a predictor among {known}; got {self.predictor}")
        for what, value in (("at", self.at), ("ms", self.ms)):
            if not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"knee {what}: expected a finite number >= 0, got {value}")

    @property
    def name(self) -> str:
        """What posteriors and fits call it: ``knee(triangles,158000)``."""
        return f"knee({self.predictor},{repr(float(self.at)).removesuffix('.0')})"

    def frame_ms(self, total: float) -> float:
        """Return what a frame of this total costs beyond the linear price."""
        return self.ms * max(0.0, total - self.at)
