"""Cost of drawing a frame: linear terms, and a roofline of geometry against pixels per object.

``ms = base + Σ linear · x + Σ_objects max(geometry · x, pixel · x)``, the second sum over objects
being Gobbetti-Bouvier's and Funkhouser-Séquin's ``max(T_tri · triangles, T_pix · pixels)``.

One linear predictor, ``rasterized_triangles``, is a function of the level and the view.  A triangle
that covers no sample is dropped after its vertices are transformed, and costs a fraction of one
that is set up and filled.  If an object's samples fall on its triangles at random, of T triangles
in the picture ``T · (1 - exp(-samples / T))`` receive one.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from ...base.arrays import FloatArray, frozen_array, require_finite
from ...base.errors import InputError
from ...base.predictors import (
    CPU_PREDICTORS,
    GPU_PREDICTORS,
    LEVEL_PREDICTORS,
    RASTERIZED_TRIANGLES,
    SHADED_SAMPLES,
)
from ..scene.levels import LevelTable

DISC_SHARE = 0.4
"""Share of a bounding sphere's disc that a mesh covers; hulls of eight cover 0.32 to 0.46."""

_TRIANGLES = LEVEL_PREDICTORS.index("triangles")


def _vector(names: tuple[str, ...], given: Mapping[str, float], label: str) -> FloatArray:
    unknown = sorted(set(given) - set(names))
    if unknown:
        raise InputError(f"{label}: expected predictors among {', '.join(names)}; got {unknown[0]}")
    array = frozen_array([given.get(name, 0.0) for name in names], np.float64, (len(names),), label)
    require_finite(array, label, low=0.0)
    return array


class Footprint(Protocol):
    """Where m objects are in the picture; a policy's `View` is one."""

    @property
    def area_px(self) -> FloatArray:
        """Projected area of the bounding spheres, at most the viewport's, (m,)."""
        ...

    @property
    def covered_px(self) -> FloatArray:
        """Samples that the objects themselves should cover, (m,)."""
        ...

    @property
    def inside_share(self) -> FloatArray:
        """Share of each object that is in the picture, in [0, 1], (m,)."""
        ...


def rasterized_triangles(
    triangles: FloatArray, covered_px: FloatArray, inside: FloatArray
) -> FloatArray:
    """Return how many of each object's triangles should reach a sample, at most all of them.

    Parameters
    ----------
    covered_px, inside
        As `Footprint.covered_px` and `Footprint.inside_share`.
    """
    seen = triangles * inside
    per_triangle = np.divide(covered_px, seen, out=np.zeros(seen.shape), where=seen > 0.0)
    return seen * -np.expm1(-per_triangle)


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
    has_roofline, rasterized_ms : derived
        Whether any of these is positive; milliseconds per triangle that reaches a sample.
    """

    base_ms: float
    linear_ms: FloatArray
    roofline_ms: FloatArray
    has_roofline: bool = field(init=False)
    rasterized_ms: float = field(init=False)

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
        put(self, "rasterized_ms", float(self.linear_ms[RASTERIZED_TRIANGLES]))

    @classmethod
    def of(
        cls,
        base_ms: float,
        linear: Mapping[str, float],
        roofline: Mapping[str, float] | None = None,
    ) -> "CostModel":
        """Build a model from milliseconds per unit by predictor name.

        Raises `InputError` if a predictor is unknown or a coefficient negative or not finite.
        """
        return cls(
            base_ms,
            _vector(GPU_PREDICTORS, linear, "linear"),
            _vector(GPU_PREDICTORS, roofline or {}, "roofline"),
        )

    def level_ms(self, levels: LevelTable) -> tuple[FloatArray, FloatArray]:
        """Return what the levels contribute to `object_ms`: milliseconds, and geometry.

        The first, (L,), is linear cost whatever the view.  The second, (L, 2), is what meets the
        pixels: milliseconds of the roofline, and triangles.
        """
        count = len(LEVEL_PREDICTORS)
        geometry = np.column_stack(
            (levels.counts @ self.roofline_ms[:count], levels.counts[:, _TRIANGLES])
        )
        return levels.counts @ self.linear_ms[:count], geometry

    def object_ms(
        self,
        linear: FloatArray,
        geometry: FloatArray,
        seen: Footprint,
        pixel_share: float = 1.0,
    ) -> FloatArray:
        """Return the marginal cost of objects by level and footprint, (m,) or (m, L).

        Parameters
        ----------
        linear, geometry
            (m,) and (m, 2), or (m, L) and (m, L, 2) for L levels of each object: rows of what
            `level_ms` returns.
        pixel_share
            Pixels of the picture over those of the window.
        """
        column = (slice(None), None) if linear.ndim == 2 else slice(None)
        area_px = pixel_share * seen.area_px[column]
        cost = linear + self.linear_ms[SHADED_SAMPLES] * area_px
        if self.has_roofline:
            cost = cost + np.maximum(geometry[..., 0], self.roofline_ms[SHADED_SAMPLES] * area_px)
        if self.rasterized_ms:
            covered_px = pixel_share * seen.covered_px[column]
            reached = rasterized_triangles(geometry[..., 1], covered_px, seen.inside_share[column])
            cost = cost + self.rasterized_ms * reached
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
