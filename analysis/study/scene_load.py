"""Where a scene's load is, for the paths that look for it."""

import numpy as np

from ...base.arrays import FloatArray
from ...base.predictors import LEVEL_PREDICTORS
from ...models.scene.scene import Scene
from ...traces.cameras.generators.load_map import LoadMap

_PRIMITIVES = [LEVEL_PREDICTORS.index(name) for name in ("triangles", "splats")]


def map_load(
    scene: Scene,
    center_m: tuple[float, float],
    size_m: tuple[float, float],
    way_m: FloatArray | None = None,
) -> LoadMap:
    """Return the primitives of a scene at full detail by place, over a plan for the eye.

    Of a tree its leaves count, and what stays drawn with them.  Objects that move count where they
    are at rest.  Walls hide nothing here.
    """
    finest = scene.types.levels.counts[scene.types.levels.start[:-1]]
    primitives = finest[:, _PRIMITIVES].sum(axis=1)
    full = (np.diff(scene.child_start) == 0) | scene.additive
    # A scene of impostors or empty tiles has no primitives, and still things to look at.
    load = np.maximum(primitives[scene.type_index[full]], 1.0)
    place = scene.center_m[full, :2]
    return LoadMap.of(place, load, np.array(center_m), np.array(size_m), way_m)
