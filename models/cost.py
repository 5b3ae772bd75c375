"""Cost of drawing a frame: linear terms, and a roofline of geometry against pixels per object.

``ms = base + Σ linear · x + Σ_objects max(geometry · x, pixel · x)``, the second sum over objects
being Gobbetti-Bouvier's and Funkhouser-Séquin's ``max(T_tri · triangles, T_pix · pixels)``.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..errors import InputError
from .arrays import FloatArray, frozen_array, require_finite
from .levels import LevelTable
from .predictors import CPU_PREDICTORS, GPU_PREDICTORS, LEVEL_PREDICTORS, SHADED_SAMPLES

__all__ = ["CostModel", "CpuCostModel"]


def _vector(names: tuple[str, ...], given: Mapping[str, float], label: str) -> FloatArray:
    unknown = sorted(set(given) - set(names))
    if unknown:
        raise InputError(f"{label}: expected predictors among {', '.join(names)}; got {unknown[0]}")
    array = frozen_array([given.get(name, 0.0) for name in names], np.float64, (len(names),), label)
    require_finite(array, label, low=0.0)
    return array


@dataclass(frozen=True, slots=True)
class CostModel:
    """GPU milliseconds of a frame.

    Attributes
    ----------
    base_ms : float
        Cost of an empty frame.
    linear_ms : (P,) float64
        Milliseconds per unit, in the order of `GPU_PREDICTORS`.
    roofline_ms : (P,) float64
        Milliseconds per unit of the roofline term; ``shaded_samples`` is its pixel side, every
        level predictor its geometry side.
    """

    base_ms: float
    linear_ms: FloatArray
    roofline_ms: FloatArray
    has_roofline: bool = field(init=False)

    def __post_init__(self) -> None:
        size = (len(GPU_PREDICTORS),)
        put = object.__setattr__
        for name in ("linear_ms", "roofline_ms"):
            array = frozen_array(getattr(self, name), np.float64, size, name)
            require_finite(array, name, low=0.0)
            put(self, name, array)
        if not (np.isfinite(self.base_ms) and self.base_ms >= 0.0):
            raise InputError(f"base: expected milliseconds >= 0, got {self.base_ms}")
        put(self, "has_roofline", bool(self.roofline_ms.any()))

    @classmethod
    def of(
        cls,
        base_ms: float,
        linear: Mapping[str, float],
        roofline: Mapping[str, float] | None = None,
    ) -> "CostModel":
        """Build a model from milliseconds per unit by predictor name.

        Raises
        ------
        InputError
            If a predictor is unknown or a coefficient negative or not finite.
        """
        return cls(
            base_ms,
            _vector(GPU_PREDICTORS, linear, "linear"),
            _vector(GPU_PREDICTORS, roofline or {}, "roofline"),
        )

    def level_ms(self, levels: LevelTable) -> tuple[FloatArray, FloatArray]:
        """Return linear and roofline geometry cost of each level, whatever the view, both (L,)."""
        count = len(LEVEL_PREDICTORS)
        return (
            levels.counts @ self.linear_ms[:count],
            levels.counts @ self.roofline_ms[:count],
        )

    def object_ms(
        self, linear: FloatArray, geometry: FloatArray, area_px: FloatArray
    ) -> FloatArray:
        """Return the marginal cost of objects from their level costs and projected areas, (m,)."""
        cost = linear + self.linear_ms[SHADED_SAMPLES] * area_px
        if self.has_roofline:
            cost = cost + np.maximum(geometry, self.roofline_ms[SHADED_SAMPLES] * area_px)
        return cost


@dataclass(frozen=True, slots=True)
class CpuCostModel:
    """CPU milliseconds of a frame: base and milliseconds per unit of `CPU_PREDICTORS`."""

    base_ms: float
    linear_ms: FloatArray

    def __post_init__(self) -> None:
        size = (len(CPU_PREDICTORS),)
        array = frozen_array(self.linear_ms, np.float64, size, "cpu linear_ms")
        require_finite(array, "cpu linear_ms", low=0.0)
        object.__setattr__(self, "linear_ms", array)
        if not (np.isfinite(self.base_ms) and self.base_ms >= 0.0):
            raise InputError(f"cpu base: expected milliseconds >= 0, got {self.base_ms}")

    @classmethod
    def of(cls, base_ms: float, linear: Mapping[str, float]) -> "CpuCostModel":
        """Build a model from milliseconds per unit by predictor name; raises InputError."""
        return cls(base_ms, _vector(CPU_PREDICTORS, linear, "cpu linear"))
