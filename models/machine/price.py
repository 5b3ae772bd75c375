"""What a frame was counted by and what it costs, level by level and as a whole."""

from typing import NamedTuple

from ...base.arrays import FloatArray
from ...base.predictors import GPU_PREDICTORS, LEVEL_PREDICTORS

_OF_TERMS = GPU_PREDICTORS[len(LEVEL_PREDICTORS) :]


class Load(NamedTuple):
    """What a frame draws of each level, wherever that is in the picture.

    Attributes
    ----------
    times_drawn : (L,) float64
        How often each level is drawn.
    counts : list of float
        Units of the levels drawn, in the order of `LEVEL_PREDICTORS`.
    level_ms : float
        What these levels cost whatever the view.
    types : int
        Distinct types drawn.
    """

    times_drawn: FloatArray
    counts: list[float]
    level_ms: float
    types: int


class Price(NamedTuple):
    """GPU time of a whole frame, and what it was counted by.

    Attributes
    ----------
    gpu_ms : float
        Noise-free.
    load : Load
    counts : dict of str to float
        Units of the view's and the frame's terms, by predictor; NaN where a term costs nothing and
        its units take time to count.
    terms_ms : list of float
        What these cost, terms of one unit together, in the order in which they are added up.
    """

    gpu_ms: float
    load: Load
    counts: dict[str, float]
    terms_ms: list[float]

    @property
    def units(self) -> list[float]:
        """Units in the order of `GPU_PREDICTORS`."""
        return [*self.load.counts, *map(self.counts.__getitem__, _OF_TERMS)]
