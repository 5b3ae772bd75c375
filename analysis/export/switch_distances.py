"""Between which distances a threshold policy keeps each level of an object at scale 1."""

import math
from dataclasses import dataclass

from ...models.scene.scene import Scene
from ...policies.thresholds.static_distance import StaticDistance, distance_range
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


def switches_by_distance(policy: StaticDistance, scene: Scene, levels: int) -> list[Switch]:
    """Return where each level but the finest begins: the range is divided evenly among all."""
    near_m, far_m = distance_range("static-distance", scene, policy.near_m, policy.far_m)
    step_m = (far_m - near_m) / levels
    outs_m = [policy.scale * (near_m + level * step_m) for level in range(1, levels)]
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
        return switches_by_distance(policy, scene, levels)
    return switches_by_height(policy, radius_m, levels, fovy_deg)


def counted_types(scene: Scene) -> list[tuple[str, float, int]]:
    """Return name, radius in metres at scale 1 and number of levels of each type."""
    types = scene.types
    rows = zip(types.names, types.radius_m, types.levels.level_count, strict=True)
    return [(name, float(radius_m), int(levels)) for name, radius_m, levels in rows]
