"""The choice of a layout and what surrounds it: free space, side, names."""

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from .city_blocks import city
from .forest import forest
from .grid import grid
from .packing import require_side
from .rows import rows
from .scatter import scatter

LAYOUTS = ("grid", "scatter", "rows", "city", "forest")


def require_layout(name: str, spacing_m: float, side_m: float | None) -> None:
    """Raise InputError unless there is a layout of that name, and the lengths can be."""
    if name not in LAYOUTS:
        raise InputError(f"layout: expected {', '.join(LAYOUTS)}, got {name}")
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
    rng : consumed by scatter and forest only
    spacing_m : free distance between any two circles, at least 0
    side_m : side of the square about the origin that holds every circle; by default as large as
        the layout needs
    """
    require_layout(layout, spacing_m, side_m)
    wide = radius_m + spacing_m / 2.0
    if layout == "scatter":
        return scatter(wide, side_m, rng)
    if layout == "forest":
        return forest(wide, side_m, rng)
    centers = {"grid": grid, "rows": rows, "city": city}[layout](wide)
    if side_m is not None:
        needed = 2.0 * float((np.abs(centers).max(axis=1) + wide).max())
        require_side(side_m, needed, len(wide), layout)
    return centers
