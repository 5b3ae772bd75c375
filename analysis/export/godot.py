"""Godot: the threshold of mesh LOD, or visibility ranges of the levels.

`pixel-error` is the rule of mesh LOD, whose threshold is a setting of the project.  Policies that
go by distance are visibility ranges, one instance a level.  Without fading a margin m is a
hysteresis: an instance appears beyond ``begin + m`` and is gone within ``begin - m``, so that a
switch out at T and back at B has its begin in the middle, and half their distance for margin.

Source: Godot's class reference, ``GeometryInstance3D.visibility_range_begin``, ``_end``,
``_begin_margin``, ``_end_margin`` (centre of the bounds; 0 for no end), and
``rendering/mesh_lod/lod_change/threshold_pixels``.  That Godot's importer measures errors as
lodbench does is assumed.
"""

from collections.abc import Sequence
from itertools import pairwise

from ...policies.thresholds.pixel_error import PixelError
from ...policies.thresholds.static_screen import StaticScreen
from .engine_settings import Asked, Engine, EngineSettings, TypeSettings
from .switch_distances import Switch, about_distances, counted_types, switches_of

_THRESHOLD = "rendering/mesh_lod/lod_change/threshold_pixels"


def _set_godot(asked: Asked) -> EngineSettings:
    if isinstance(asked.policy, PixelError):
        return _mesh_lod(asked, asked.policy)
    scene = asked.flat_scene()
    types = tuple(
        TypeSettings(
            name,
            radius_m,
            {},
            _levels(switches_of(asked.policy, scene, radius_m, levels, asked.fovy_deg)),
        )
        for name, radius_m, levels in counted_types(scene)
    )
    differs = [
        "visibility_range_fade_mode is to be VISIBILITY_RANGE_FADE_DISABLED",
        *about_distances(asked.policy, asked.fovy_deg),
    ]
    by_height = isinstance(asked.policy, StaticScreen)
    fovy_deg = asked.fovy_deg if by_height else None
    differs += asked.about_knots()
    return EngineSettings("godot", asked.label, scene.name, fovy_deg, {}, types, tuple(differs))


def _mesh_lod(asked: Asked, policy: PixelError) -> EngineSettings:
    differs = ["that the importer measures errors as lodbench does is assumed"]
    if policy.hysteresis:
        differs.append(
            f"mesh LOD has no hysteresis: hysteresis={policy.hysteresis:g} is lost; "
            "hysteresis=0 simulates that"
        )
    project: dict[str, float | bool] = {
        _THRESHOLD: policy.threshold_px,
        "GeometryInstance3D.lod_bias": 1.0,
    }
    return EngineSettings("godot", asked.label, None, None, project, (), tuple(differs))


def _levels(switches: Sequence[Switch]) -> tuple[dict[str, float], ...]:
    # Nothing ends a range or begins it where begin, or end, is 0.
    edges = [(0.0, 0.0), *map(_edge, switches), (0.0, 0.0)]
    return tuple(
        {
            "visibility_range_begin": begin,
            "visibility_range_begin_margin": begin_margin,
            "visibility_range_end": end,
            "visibility_range_end_margin": end_margin,
        }
        for (begin, begin_margin), (end, end_margin) in pairwise(edges)
    )


def _edge(switch: Switch) -> tuple[float, float]:
    return 0.5 * (switch.out_m + switch.back_m), 0.5 * (switch.out_m - switch.back_m)


GODOT = Engine(("pixel-error", "static-distance", "static-screen"), _set_godot)
