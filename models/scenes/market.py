"""A market square: other meshes than plaza's in the open, to validate what was fitted there.

1,500 pieces of the seven kinds of furniture that stand in soda-hall, two to three times as large as
there, so that they fill as much of the view as the objects of plaza do.
"""

import numpy as np

from ..layouts.placement import place
from ..layouts.scene_builder import scene_of_objects
from ..meshes.geometry import Geometry
from ..meshes.mesh_error import Sampling
from ..meshes.simplify import ChainOptions, build_chain
from ..scene.scene import Scene
from .parts.furniture import make_furniture
from .scene_registry import BundledScene

_SEED = 1801
_PIECES = 1_500
_SIDE_M = 240.0
_CHAIN = ChainOptions(levels=4, ratio=0.4, min_triangles=12)
_SAMPLING = Sampling(vertices=2_000, surface=500)


def build_market() -> tuple[Scene, Geometry]:
    """Return 1,500 pieces scattered over 240 m by 240 m."""
    shape_rng, place_rng = np.random.default_rng(_SEED).spawn(2)
    models = [build_chain(mesh, _CHAIN, _SAMPLING) for mesh in make_furniture(shape_rng)]
    kind = np.arange(_PIECES, dtype=np.int32) % len(models)
    scale = place_rng.uniform(2.0, 3.0, _PIECES)
    radius = scale * np.array([model.radius_m for model in models])[kind]
    plan = place("scatter", radius, place_rng, side_m=_SIDE_M)
    yaw = place_rng.uniform(-np.pi, np.pi, _PIECES)
    return scene_of_objects("market", models, kind, plan, yaw, scale)


MARKET = BundledScene(
    "1,500 pieces of furniture in the open, of 136 to 1,824 triangles", build_market
)
