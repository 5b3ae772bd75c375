"""three.js: the distances of `LOD.addLevel`, with hysteresis.

Level i is drawn from its distance on; while it is the one drawn, its distance is lowered by the
hysteresis share, so that a switch out at T and back at B has the distance T and the hysteresis
``1 - B / T``.  Distances are divided by the camera's zoom, and know nothing of the field of view.

Source: three.js's documentation of ``LOD.addLevel(object, distance, hysteresis)``; the policy
`static-distance` is held against its code (docs/peers.md).
"""

from ...policies.thresholds.static_screen import StaticScreen
from .engine_settings import Asked, Engine, EngineSettings, TypeSettings
from .switch_distances import Switch, about_distances, counted_types, switches_of


def _set_threejs(asked: Asked) -> EngineSettings:
    scene = asked.flat_scene()
    types = tuple(
        TypeSettings(
            name,
            radius_m,
            {},
            (
                {"distance": 0.0, "hysteresis": 0.0},
                *map(_level, switches_of(asked.policy, scene, radius_m, levels, asked.fovy_deg)),
            ),
        )
        for name, radius_m, levels in counted_types(scene)
    )
    differs = [
        "LOD stands at its origin, which is to be the centre of the bounding sphere",
        *about_distances(asked.policy, asked.fovy_deg),
    ]
    by_height = isinstance(asked.policy, StaticScreen)
    fovy_deg = asked.fovy_deg if by_height else None
    differs += asked.about_knots()
    return EngineSettings("threejs", asked.label, scene.name, fovy_deg, {}, types, tuple(differs))


def _level(switch: Switch) -> dict[str, float]:
    return {"distance": switch.out_m, "hysteresis": 1.0 - switch.back_m / switch.out_m}


THREEJS = Engine(("static-distance", "static-screen"), _set_threejs)
