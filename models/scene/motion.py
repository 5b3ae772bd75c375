"""Motion of objects: some nodes go round horizontal circles through their rest position."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ...base.arrays import FloatArray, IntArray, freeze


@dataclass(frozen=True, slots=True)
class Motion:
    """M moving nodes; closed form in time, so that a replay needs no integration.

    Attributes
    ----------
    node : (M,) int32
    radius_m : (M,) float64
    rate_rad_s : (M,) float64
    phase_rad : (M,) float64
    """

    node: Annotated[IntArray, np.int32, "M"]
    radius_m: Annotated[FloatArray, np.float64, "M"]
    rate_rad_s: Annotated[FloatArray, np.float64, "M"]
    phase_rad: Annotated[FloatArray, np.float64, "M"]

    def __post_init__(self) -> None:
        freeze(self, "motion", M=len(self.node))

    def offset_m(self, time_s: float) -> FloatArray:
        """Return (M, 3) displacements from rest at a time; zero at time 0."""
        angle = self.phase_rad + self.rate_rad_s * time_s
        x = self.radius_m * (np.cos(angle) - np.cos(self.phase_rad))
        y = self.radius_m * (np.sin(angle) - np.sin(self.phase_rad))
        return np.stack((x, y, np.zeros(len(angle))), axis=1)
