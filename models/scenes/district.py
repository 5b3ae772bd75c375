"""The bundled scene ``district``, made to tell policies apart: few objects of dense meshes.

630 objects of seven types of 20,480 to 58,800 triangles at full detail, in seven levels, on flat
ground about the origin, x to the east and y to the north.  From west to east:

========  ======  ================  ===========================================================
region    number  between x (m)     what stands there
========  ======  ================  ===========================================================
park      40      -350 and -190     trees, statues and boulders, far apart
quarter   390     -190 and 190      towers, houses, chapels, and fountains, statues, trees between
gardens   200     190 and 370       groves of trees, statues, fountains and boulders
========  ======  ================  ===========================================================

At full detail all of it takes several times a frame of 60 Hz on ``desktop-assumed``, and few
objects keep replays fast.  The edge between park and quarter is where load begins.
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
from ..scene.scene import Scene
from .parts.district_meshes import (
    boulder_mesh,
    chapel_mesh,
    fountain_mesh,
    house_mesh,
    statue_mesh,
    tower_mesh,
    tree_mesh,
)
from .scene_registry import BundledScene

_SEED = 60
_CHAIN = ChainOptions(levels=7, ratio=0.48, min_triangles=48)
_SAMPLING = Sampling(vertices=5_000, surface=1_000)
_MAKERS = (
    tower_mesh,
    house_mesh,
    chapel_mesh,
    fountain_mesh,
    statue_mesh,
    tree_mesh,
    boulder_mesh,
)
_TOWER, _HOUSE, _CHAPEL, _FOUNTAIN, _STATUE, _TREE, _BOULDER = range(len(_MAKERS))


@dataclass(frozen=True, slots=True)
class _Region:
    """A square of objects: so many of each kind, laid out about the middle of its plan."""

    counts: dict[int, int]
    layout: str
    center_m: tuple[float, float]
    side_m: float


_REGIONS = (
    _Region({_TREE: 20, _STATUE: 10, _BOULDER: 10}, "scatter", (-270.0, 0.0), 160.0),
    _Region(
        {_TOWER: 40, _HOUSE: 190, _CHAPEL: 30, _FOUNTAIN: 30, _STATUE: 40, _TREE: 60},
        "scatter",
        (0.0, 0.0),
        380.0,
    ),
    _Region({_TREE: 110, _STATUE: 40, _FOUNTAIN: 20, _BOULDER: 30}, "forest", (280.0, 0.0), 180.0),
)


@cache
def build_district() -> tuple[Scene, Geometry]:
    """Return the scene and its geometry, the same on every call."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    models = [build_chain(make(shape_rng), _CHAIN, _SAMPLING) for make in _MAKERS]
    radius_m = np.array([model.radius_m for model in models])
    placed = [_populate(region, radius_m, place_rng) for region in _REGIONS]
    kind = np.concatenate([kinds for kinds, _ in placed])
    plan = np.concatenate([plans for _, plans in placed])
    yaw = place_rng.uniform(-np.pi, np.pi, len(kind))
    return scene_of_objects("district", models, kind, plan, yaw, np.ones(len(kind)))


def _populate(
    region: _Region, radius_m: FloatArray, rng: np.random.Generator
) -> tuple[IntArray, FloatArray]:
    """Return kinds (n,) and plan (n, 2) of a region's objects."""
    kinds = np.repeat(list(region.counts), list(region.counts.values()))
    kind = rng.permutation(kinds).astype(np.int32)
    plan = place(region.layout, radius_m[kind], rng, side_m=region.side_m)
    return kind, plan + np.array(region.center_m)


DISTRICT = BundledScene("630 dense objects: a park, a quarter of houses, gardens", build_district)
