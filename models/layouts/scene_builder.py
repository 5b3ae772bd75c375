"""Scenes from types and a layout."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.errors import InputError
from ..meshes.geometry import Geometry
from ..meshes.type_model import TypeModel, gather_types
from ..scene.motion import Motion
from ..scene.rotation import rotate
from ..scene.scene import Scene
from .placement import place, require_layout

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
        if not 1 <= self.count <= _MAX_COUNT:
            raise InputError(f"count: expected 1 to {_MAX_COUNT}, got {self.count}")
        if not 0.0 <= self.scale_variation < 1.0:
            raise InputError(f"scale variation: expected [0, 1), got {self.scale_variation}")


def build_scene(
    name: str, models: Sequence[TypeModel], options: PlacementOptions, rng: np.random.Generator
) -> tuple[Scene, Geometry]:
    """Place objects of the types and return the scene with the geometry of its levels.

    Raises `InputError` if the layout cannot hold the objects.
    """
    count = options.count
    kind = rng.permutation(np.arange(count) % len(models)).astype(np.int32)
    spread = options.scale_variation
    scale = rng.uniform(1.0 - spread, 1.0 + spread, count)
    yaw = rng.uniform(-np.pi, np.pi, count) if options.random_yaw else np.zeros(count)
    radius = scale * np.array([model.radius_m for model in models])[kind]
    plan = place(options.layout, radius, rng, spacing_m=options.spacing_m, side_m=options.side_m)
    return scene_of_objects(name, models, kind, plan, yaw, scale, np.ones(count))


def scene_of_objects(
    name: str,
    models: Sequence[TypeModel],
    type_index: IntArray,
    plan_m: FloatArray,
    yaw_rad: FloatArray,
    scale: FloatArray,
    importance: FloatArray,
    motion: Motion | None = None,
) -> tuple[Scene, Geometry]:
    """Return a flat scene of N objects that stand upright on the ground plane z = 0.

    Parameters
    ----------
    type_index : (N,)
    plan_m : (N, 2) centres of the bounding spheres, seen from above
    yaw_rad, scale, importance : (N,)
    """
    n = len(type_index)
    zero = np.zeros(n)
    types, geometry = gather_types(models)
    turn = np.stack((zero, zero, np.sin(yaw_rad / 2), np.cos(yaw_rad / 2)), axis=1)
    center = scale[:, None] * rotate(turn, types.center_m[type_index])
    scene = Scene(
        name=name,
        types=types,
        type_index=type_index,
        position_m=np.column_stack((plan_m - center[:, :2], zero)),
        orientation_xyzw=turn,
        scale=scale,
        importance=importance,
        parent=np.full(n, -1, dtype=np.int32),
        additive=np.zeros(n, dtype=np.bool_),
        motion=motion,
    )
    return scene, geometry
