"""Unreal: screen sizes of levels, and the hysteresis of skeletal meshes.

Unreal's screen size is the diameter of the bounding sphere over the screen's wider half-angle,
``2 max(M00, M11) / 2 · radius / distance`` of the projection matrix: where the picture is at least
as wide as high that is the height that `static-screen` goes by.  The screen size of level i is that
below which it is drawn, so that of level 0 counts for nothing; the bias is in the sizes here.

Source: Epic's documentation of the static mesh editor (screen size) and API reference,
``FSkelMeshObjectLODInfo`` (ScreenSize, LODHysteresis: "a change from LOD0 -> LOD1 will occur at
ScreenSize level, but a change from LOD1 -> LOD0 [...] when the object size is ScreenSize +
LODHysteresis").
"""

from ...policies.thresholds.static_screen import StaticScreen
from .engine_settings import Asked, Engine, EngineSettings, TypeSettings
from .switch_distances import counted_types, height_thresholds

_SIZE, _HYSTERESIS = "ScreenSize", "LODHysteresis"
_LARGEST = 1.0  # the editor's screen size of level 0


def _set_unreal(asked: Asked) -> EngineSettings:
    policy: StaticScreen = asked.policy
    scene = asked.flat_scene()
    types = tuple(
        TypeSettings(name, radius_m, {}, _levels(policy, levels))
        for name, radius_m, levels in counted_types(scene)
    )
    differs = ["the screen is taken to be at least as wide as high"]
    if policy.hysteresis:
        differs.append(
            "static meshes have no LODHysteresis and switch back where they switched; skeletal "
            "meshes have it; hysteresis=0 simulates none"
        )
    return EngineSettings(
        "unreal", asked.label, scene.name, None, {}, types, (*differs, *asked.about_knots())
    )


def _levels(policy: StaticScreen, count: int) -> tuple[dict[str, float], ...]:
    sizes = [height / policy.bias for height in height_thresholds(policy, count)]
    first = max(_LARGEST, *sizes) if sizes else _LARGEST  # sizes are to descend
    margin = policy.hysteresis / policy.bias
    return tuple({_SIZE: size, _HYSTERESIS: margin} for size in (first, *sizes))


UNREAL = Engine(("static-screen",), _set_unreal)
