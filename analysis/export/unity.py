"""Unity: relative heights of `LODGroup`, and the LOD bias of the quality settings.

Unity draws level i while ``size · lodBias / (distance · 2 tan(fov / 2))`` is at least the level's
transition height; size is that of `LODGroup`, at the object's scale.  With a size of two radii it
is the height that `static-screen` goes by.  Below the last transition height an object is culled,
which is why that is 0 here.

Source: Unity's scripting reference, ``LOD.screenRelativeTransitionHeight`` (0 to 1),
``LODGroup.size``, ``LODGroup.localReferencePoint`` and ``QualitySettings.lodBias``; the formula is
that of its C# reference source.
"""

from ...base.errors import InputError
from ...policies.thresholds.static_screen import StaticScreen
from .engine_settings import Asked, Engine, EngineSettings, TypeSettings
from .switch_distances import counted_types, height_thresholds

_HEIGHT = "LOD.screenRelativeTransitionHeight"
_LEAST_BIAS = 0.1  # of QualitySettings.lodBias


def _set_unity(asked: Asked) -> EngineSettings:
    policy: StaticScreen = asked.policy
    if policy.first > 1.0:
        raise InputError(
            f"unity: expected first of at most 1, the height of the screen, got {policy.first:g}; "
            f"divide first, hysteresis and bias by {policy.first:g}: it is the same policy"
        )
    if policy.bias < _LEAST_BIAS:
        raise InputError(
            f"unity: expected bias of at least {_LEAST_BIAS:g}, the least lodBias, got "
            f"{policy.bias:g}; multiply bias, first and hysteresis by "
            f"{_LEAST_BIAS / policy.bias:g}: it is the same policy"
        )
    scene = asked.flat_scene()
    types = tuple(
        TypeSettings(
            name,
            radius_m,
            {"LODGroup.size": 2.0 * radius_m},
            tuple({_HEIGHT: height} for height in (*height_thresholds(policy, levels), 0.0)),
        )
        for name, radius_m, levels in counted_types(scene)
    )
    return EngineSettings(
        "unity",
        asked.label,
        scene.name,
        None,
        {"QualitySettings.lodBias": policy.bias},
        types,
        (*_differences(policy), *asked.about_knots()),
    )


def _differences(policy: StaticScreen) -> list[str]:
    found = ["LODGroup.localReferencePoint is to be the centre of the bounding sphere"]
    if policy.hysteresis:
        found.append(
            f"LODGroup has no hysteresis: hysteresis={policy.hysteresis:g} is lost, and levels "
            "switch back where they switched; hysteresis=0 simulates that"
        )
    return found


UNITY = Engine(("static-screen",), _set_unity)
