"""Motion of objects: some nodes go round horizontal circles through their rest position."""

from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray, IntArray, frozen_array, require_finite


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

    node: IntArray
    radius_m: FloatArray
    rate_rad_s: FloatArray
    phase_rad: FloatArray

    def __post_init__(self) -> None:
        m = len(self.node)
        put = object.__setattr__
        put(self, "node", frozen_array(self.node, np.int32, (m,), "motion node"))
        for name in ("radius_m", "rate_rad_s", "phase_rad"):
            array = frozen_array(getattr(self, name), np.float64, (m,), f"motion {name}")
            require_finite(array, f"motion {name}")
            put(self, name, array)

    def offset_m(self, time_s: float) -> FloatArray:
        """Return (M, 3) displacements from rest at a time; zero at time 0."""
        angle = self.phase_rad + self.rate_rad_s * time_s
        x = self.radius_m * (np.cos(angle) - np.cos(self.phase_rad))
        y = self.radius_m * (np.sin(angle) - np.sin(self.phase_rad))
        return np.stack((x, y, np.zeros(len(angle))), axis=1)
