"""The bundled scene ``plaza``: a field of rocks, a square with people, a town, a wood.

3,000 objects of four types on flat ground about the origin, x to the east and y to the north.
From west to east:

======  ======  ===============================  ==========  ==================================
type    number  between x (m)                    importance  layout
======  ======  ===============================  ==========  ==================================
rock    900     -445 and -245                    0.5         scatter, scales 0.5 to 1.5
figure  800     -245 and -145                    2           scatter; 500 walk in small rings
house   320     -145 and 125                     1.5         city, 16 blocks about a main street
tree    980     125 and 445                      1           forest, scales 0.75 to 1.25
======  ======  ===============================  ==========  ==================================

The main street is the x axis.  A walk along it from the west end meets ever more load; from the
west end all objects stand ahead, and a look outward from the edge sees none.  Nothing hides
anything, as occluded objects are drawn all the same.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ..layouts.placement import place
from ..layouts.scene_builder import scene_of_objects
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.simplify import ChainOptions, build_chain
from ..meshes.type_model import TypeModel
from ..scene.motion import Motion
from ..scene.scene import Scene
from .parts.plaza_meshes import figure_mesh, house_mesh, rock_mesh, tree_mesh
from .scene_registry import BundledScene

_SEED = 20250
_WALKERS = 500


@dataclass(frozen=True, slots=True)
class _Region:
    count: int
    layout: str
    center_x_m: float
    side_m: float
    importance: float
    scale_variation: float


# In the order of the types: rock, figure, house, tree.
_REGIONS = (
    _Region(900, "scatter", -345.0, 200.0, 0.5, 0.5),
    _Region(800, "scatter", -195.0, 100.0, 2.0, 0.1),
    _Region(320, "city", -10.0, 270.0, 1.5, 0.0),
    _Region(980, "forest", 285.0, 320.0, 1.0, 0.25),
)
_FIGURE = 1


@cache
def build_plaza() -> tuple[Scene, Geometry]:
    """Return the scene and its geometry, the same on every call."""
    shape_rng, place_rng, motion_rng = np.random.default_rng(_SEED).spawn(3)
    chain = ChainOptions(levels=5, ratio=0.45, min_triangles=48)
    sampling = Sampling(vertices=5_000, surface=100)
    models = [
        build_chain(make(shape_rng), chain, sampling)
        for make in (rock_mesh, figure_mesh, house_mesh, tree_mesh)
    ]
    regions = zip(_REGIONS, models, strict=True)
    placed = [_populate(region, model, place_rng) for region, model in regions]
    counts = [region.count for region in _REGIONS]
    kind = np.repeat(np.arange(len(models), dtype=np.int32), counts)
    return scene_of_objects(
        "plaza",
        models,
        kind,
        np.concatenate([plan for plan, _ in placed]),
        place_rng.uniform(-np.pi, np.pi, len(kind)),
        np.concatenate([scale for _, scale in placed]),
        np.repeat([region.importance for region in _REGIONS], counts),
        _walkers(kind, motion_rng),
    )


def _populate(
    region: _Region, model: TypeModel, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Return the plan (n, 2) and the scales (n,) of a region's objects."""
    spread = region.scale_variation
    scale = rng.uniform(1.0 - spread, 1.0 + spread, region.count)
    plan = place(region.layout, scale * model.radius_m, rng, side_m=region.side_m)
    return plan + np.array((region.center_x_m, 0.0)), scale


def _walkers(kind: IntArray, rng: np.random.Generator) -> Motion:
    """Return rings of 1 to 4 m that some figures walk at 0.8 to 1.6 m/s, either way round."""
    node = rng.choice(np.flatnonzero(kind == _FIGURE), _WALKERS, replace=False)
    radius = rng.uniform(1.0, 4.0, _WALKERS)
    speed = rng.uniform(0.8, 1.6, _WALKERS) * rng.choice((-1.0, 1.0), _WALKERS)
    phase = rng.uniform(0.0, 2.0 * np.pi, _WALKERS)
    return Motion(np.sort(node).astype(np.int32), radius, speed / radius, phase)


PLAZA = BundledScene("3,000 rocks, people, houses and trees", build_plaza)
