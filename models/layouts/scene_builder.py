"""Scenes from types and a layout."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ...base.arrays import FloatArray, IntArray
from ...base.errors import InputError, require_between
from ..meshes.geometry import Geometry
from ..meshes.type_model import TypeModel, gather_types
from ..scene.motion import Motion
from ..scene.rotation import rotate, turn_about_z
from ..scene.scene import Scene
from .placement import place, require_layout
from .placements_file import Placements

_MAX_COUNT = 10_000_000


@dataclass(frozen=True, slots=True)
class PlacementOptions:
    """How many objects stand where.

    Attributes
    ----------
    layout : one of `LAYOUTS`
    count : int
        Objects in all, in equal shares of the types.
    spacing_m : float
        Free distance between any two bounding spheres.
    side_m : float, optional
        Side of the square about the origin that holds every bounding sphere.
    scale_variation : float
        Scales are uniform in ``1 ± scale_variation``; in [0, 1).
    random_yaw : bool
        Whether objects are turned about the vertical at random; otherwise all face alike.
    """

    layout: str = "scatter"
    count: int = 500
    spacing_m: float = 1.0
    side_m: float | None = None
    scale_variation: float = 0.0
    random_yaw: bool = True

    def __post_init__(self) -> None:
        require_layout(self.layout, self.spacing_m, self.side_m)
        require_between(self.count, 1, _MAX_COUNT, "count")
        if not 0.0 <= self.scale_variation < 1.0:
            raise InputError(f"scale variation: expected [0, 1), got {self.scale_variation}")


def build_scene(
    name: str, models: Sequence[TypeModel], options: PlacementOptions, rng: np.random.Generator
) -> tuple[Scene, Geometry]:
    """Place objects of the types and return the scene with the geometry of its levels.

    Raises `InputError` if the layout cannot hold the objects.
    """
    placed = place_kinds(np.array([model.radius_m for model in models]), options, rng)
    return scene_of_objects(name, models, *placed)


def scene_of_placements(
    name: str, models: Sequence[TypeModel], placements: Placements
) -> tuple[Scene, Geometry]:
    """Return a flat scene of objects where a file places them, and its geometry."""
    types, geometry = gather_types(models)
    scene = Scene.of(
        name,
        types,
        placements.type_index,
        placements.position_m,
        turn_xyzw=placements.turn_xyzw,
        scale=placements.scale,
        importance=placements.importance,
    )
    return scene, geometry


def place_kinds(
    radius_m: FloatArray, options: PlacementOptions, rng: np.random.Generator
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
    """Return kinds (N,), plan (N, 2), yaw (N,) and scale (N,) of equal shares of some kinds.

    Raises `InputError` if the layout cannot hold them.

    Parameters
    ----------
    radius_m : of each kind, seen from above
    """
    count, spread = options.count, options.scale_variation
    kind = rng.permutation(np.arange(count) % len(radius_m)).astype(np.int32)
    scale = rng.uniform(1.0 - spread, 1.0 + spread, count)
    yaw = rng.uniform(-np.pi, np.pi, count) if options.random_yaw else np.zeros(count)
    radius, space = scale * radius_m[kind], options.spacing_m
    plan = place(options.layout, radius, rng, spacing_m=space, side_m=options.side_m)
    return kind, plan, yaw, scale


def scene_of_objects(
    name: str,
    models: Sequence[TypeModel],
    type_index: IntArray,
    plan_m: FloatArray,
    yaw_rad: FloatArray,
    scale: FloatArray,
    importance: ArrayLike = 1.0,
    motion: Motion | None = None,
) -> tuple[Scene, Geometry]:
    """Return a flat scene of N objects that stand upright on the ground plane z = 0.

    Parameters
    ----------
    type_index : (N,)
    plan_m : (N, 2) centres of the bounding spheres, seen from above
    yaw_rad, scale, importance : (N,)
    """
    types, geometry = gather_types(models)
    turn = turn_about_z(yaw_rad)
    center = scale[:, None] * rotate(turn, types.center_m[type_index])
    position = np.column_stack((plan_m - center[:, :2], np.zeros(len(type_index))))
    scene = Scene.of(
        name,
        types,
        type_index,
        position,
        turn_xyzw=turn,
        scale=scale,
        importance=importance,
        motion=motion,
    )
    return scene, geometry
