"""Gobbetti and Bouvier's test scene: coloured replicas of a cow, at random places on a plane.

The counts of the paper are lost in the text at hand ("hundreds of objects", "millions of
polygons").  Here 400 cows stand on 200 m by 200 m.  The cow is made up, with as many triangles as
the public mesh that the paper used has, 5,804; 2.3 million in all.  It is continuous, an ordered
mesh as the paper's.
"""

import numpy as np

from ..continuous.knots import KnotOptions, OrderedSurface, build_continuous
from ..layouts.placement import place
from ..layouts.scene_builder import scene_of_objects
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.shapes import lump, move_part, revolved
from ..meshes.surface_mesh import SurfaceMesh, clean_surface
from ..scene.scene import Scene
from .scene_registry import BundledScene

_SEED = 2000
_COWS = 400
_SIDE_M = 200.0
_RADIUS_M = 1.3  # of the ground that a cow takes
_LEAST = 58  # triangles of the coarsest cow, 1 %
_SAMPLING = Sampling(vertices=3_000, surface=2_000)


def build_cows() -> tuple[Scene, Geometry]:
    """Return 400 cows scattered over 200 m by 200 m."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    surface = OrderedSurface.of(cow_mesh(shape_rng))
    model = build_continuous(surface, KnotOptions(12, _LEAST), _SAMPLING)
    scale = place_rng.uniform(0.9, 1.1, _COWS)
    plan = place("scatter", scale * _RADIUS_M, place_rng, side_m=_SIDE_M)
    yaw = place_rng.uniform(-np.pi, np.pi, _COWS)
    return scene_of_objects("cows", [model], np.zeros(_COWS, dtype=np.int32), plan, yaw, scale)


def cow_mesh(rng: np.random.Generator) -> SurfaceMesh:
    """Return a cow 1.5 m tall of 5,804 triangles: trunk, head, legs and two horns."""
    trunk = move_part(lump(rng, 4, 0.1), (0.0, 0.0, 1.0), (0.95, 0.36, 0.42))
    head = move_part(lump(rng, 2, 0.12), (1.15, 0.0, 1.25), (0.3, 0.17, 0.2))
    legs = [
        move_part(lump(rng, 1, 0.1), (x, y, 0.4), (0.12, 0.11, 0.45))
        for x in (-0.65, 0.65)
        for y in (-0.2, 0.2)
    ]
    horns = [
        move_part(revolved([(0.0, 0.05), (0.2, 0.01)], 11), (1.1, y, 1.4), 1.0)
        for y in (-0.12, 0.12)
    ]
    return clean_surface("cow", [trunk, head, *legs, *horns]).standing(y_up=False, height_m=1.5)


COWS = BundledScene("400 cows of 5,804 triangles on a plane, continuous", build_cows)
