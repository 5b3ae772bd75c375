"""Between which distances a threshold policy keeps each level of an object at scale 1."""

import math
from dataclasses import dataclass

from ...models.scene.scene import Scene
from ...policies.shared.levels.distance_range import distance_range
from ...policies.thresholds.static_distance import StaticDistance
from ...policies.thresholds.static_screen import StaticScreen


@dataclass(frozen=True, slots=True)
class Switch:
    """Where a level begins.

    Attributes
    ----------
    out_m : float
        Distance from which it is drawn when coming from a finer level.
    back_m : float
        Distance below which the finer level is drawn again; at most `out_m`.
    """

    out_m: float
    back_m: float


def height_thresholds(policy: StaticScreen, levels: int) -> list[float]:
    """Return the biased heights below which each level but the coarsest gives way, descending."""
    return [policy.first * policy.ratio**level for level in range(levels - 1)]


def grows_with_size(policy: StaticDistance | StaticScreen) -> bool:
    """Whether distances are in proportion to an object's radius, and so to its scale."""
    return isinstance(policy, StaticScreen) or policy.near_m is policy.far_m is None


def switches_by_distance(
    policy: StaticDistance, scene: Scene, radius_m: float, levels: int
) -> list[Switch]:
    """Return where each level but the finest begins: the range is divided evenly among all."""
    near_m, far_m = (
        float(end_m[0])
        for end_m in distance_range("static-distance", scene, policy.near_m, policy.far_m)
    )
    size = radius_m / float(scene.radius_m[0]) if grows_with_size(policy) else 1.0
    step_m = (far_m - near_m) / levels
    outs_m = [policy.scale * size * (near_m + level * step_m) for level in range(1, levels)]
    return [Switch(out_m, out_m * (1.0 - policy.hysteresis)) for out_m in outs_m]


def switches_by_height(
    policy: StaticScreen, radius_m: float, levels: int, fovy_deg: float
) -> list[Switch]:
    """Return where each level but the finest begins, under one vertical field of view.

    A sphere of radius r at distance d is ``h = r / (d tan(fovy / 2))`` of the screen high.
    """
    reach_m = policy.bias * radius_m / math.tan(math.radians(fovy_deg) / 2.0)
    return [
        Switch(reach_m / height, reach_m / (height + policy.hysteresis))
        for height in height_thresholds(policy, levels)
    ]


def switches_of(
    policy: StaticDistance | StaticScreen,
    scene: Scene,
    radius_m: float,
    levels: int,
    fovy_deg: float,
) -> list[Switch]:
    """Return where each level but the finest begins, by either policy."""
    if isinstance(policy, StaticDistance):
        return switches_by_distance(policy, scene, radius_m, levels)
    return switches_by_height(policy, radius_m, levels, fovy_deg)


def about_distances(policy: StaticDistance | StaticScreen, fovy_deg: float) -> list[str]:
    """Return for what distances hold, where that is not everything."""
    at = f"{fovy_deg:g} degrees and " if isinstance(policy, StaticScreen) else ""
    if grows_with_size(policy):
        return [f"distances hold at {at}scale 1: multiply them by an object's scale"]
    return []


def counted_types(scene: Scene) -> list[tuple[str, float, int]]:
    """Return name, radius in metres at scale 1 and number of levels of each type."""
    types = scene.types
    rows = zip(types.names, types.radius_m, types.levels.level_count, strict=True)
    return [(name, float(radius_m), int(levels)) for name, radius_m, levels in rows]
