"""The choice of a layout and what surrounds it: free space, side, names."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.name_registry import Registry
from .packing import require_side

Layout: TypeAlias = Callable[[FloatArray, float | None, np.random.Generator], FloatArray]
"""Takes radii (N,), the side of the square or None, and random numbers; returns centres (N, 2)."""

LAYOUTS: Registry[Layout] = Registry(
    "layout",
    Callable,
    f"{__package__}.patterns",
    {
        "grid": "grid:grid",
        "scatter": "scatter:scatter",
        "rows": "rows:rows",
        "city": "city_blocks:city",
        "forest": "forest:forest",
    },
)


def require_layout(name: str, spacing_m: float, side_m: float | None) -> None:
    """Raise InputError unless there is a layout of that name, and the lengths can be."""
    LAYOUTS.find(name)
    if not (np.isfinite(spacing_m) and spacing_m >= 0.0):
        raise InputError(f"spacing: expected metres >= 0, got {spacing_m}")
    if side_m is not None and not (np.isfinite(side_m) and side_m > 0.0):
        raise InputError(f"side: expected metres > 0, got {side_m}")


def place(
    layout: str,
    radius_m: FloatArray,
    rng: np.random.Generator,
    *,
    spacing_m: float = 0.0,
    side_m: float | None = None,
) -> FloatArray:
    """Return centres (N, 2) in plan, about the origin, of bounding circles that do not overlap.

    Raises `InputError` if the layout is unknown, the square cannot hold the objects, or a length is
    out of range.

    Parameters
    ----------
    radius_m : (N,) positive
    rng : consumed by layouts that are random
    spacing_m : free distance between any two circles, at least 0
    side_m : side of the square about the origin that holds every circle; by default as large as
        the layout needs
    """
    require_layout(layout, spacing_m, side_m)
    wide = radius_m + spacing_m / 2.0
    centers = LAYOUTS.find(layout)(wide, side_m, rng)
    if side_m is not None:
        needed = 2.0 * float((np.abs(centers).max(axis=1) + wide).max())
        require_side(side_m, needed, len(wide), layout)
    return centers
