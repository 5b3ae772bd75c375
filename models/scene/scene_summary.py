"""A scene in a few numbers, as JSON holds them."""

from dataclasses import asdict
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...base.predictors import LEVEL_PREDICTORS
from .extent import scene_extent
from .scene import Scene
from .scene_file import SceneOrigin
from .tree import Tree


def summarise(scene: Scene, origin: SceneOrigin) -> dict[str, Any]:
    """Return types with their levels, objects, triangles at full detail, extent and origin.

    A hierarchy at full detail is its leaves, and what stays drawn beside them; `depths` has a
    record for each of its depths, and is empty in a flat scene.
    """
    kinds = len(scene.types.names)
    objects = np.bincount(scene.type_index, minlength=kinds)
    levels = scene.types.levels
    finest = levels.counts[levels.start[:-1], LEVEL_PREDICTORS.index("triangles")]
    center, size = scene_extent(scene)
    tree = Tree(scene)
    return {
        "name": scene.name,
        "objects": len(scene),
        "moving": 0 if scene.motion is None else len(scene.motion.node),
        "triangles": int(finest[scene.type_index[tree.units]].sum()),
        "depths": [] if scene.flat else _depth_records(tree, finest[scene.type_index]),
        "extent": {"center_m": center.tolist(), "size_m": size.tolist()},
        "types": [_type_record(scene, k, int(objects[k])) for k in range(kinds)],
        "origin": asdict(origin) | {"sources": list(origin.sources)},
    }


def _depth_records(tree: Tree, triangles: FloatArray) -> list[dict[str, Any]]:
    levels = tree.scene.types.levels
    error_m = levels.error_m[levels.start[:-1]][tree.scene.type_index] * tree.scene.scale
    records: list[dict[str, Any]] = []
    for depth in range(int(tree.depth.max()) + 1):
        here = tree.depth == depth
        records.append(
            {
                "depth": depth,
                "nodes": int(here.sum()),
                "leaves": int((here & tree.leaf).sum()),
                "triangles": int(triangles[here].sum()),
                "error_m_max": float(error_m[here].max()),
            }
        )
    return records


def _type_record(scene: Scene, kind: int, objects: int) -> dict[str, Any]:
    levels = scene.types.levels
    rows = range(levels.start[kind], levels.start[kind + 1])
    return {
        "name": scene.types.names[kind],
        "objects": objects,
        "radius_m": float(scene.types.radius_m[kind]),
        "continuous": bool(levels.continuous[kind]),
        "levels": [
            {
                **{name: round(levels.counts[row, i]) for i, name in enumerate(LEVEL_PREDICTORS)},
                "error_m": float(levels.error_m[row]),
                "bytes": round(levels.bytes[row]),
            }
            for row in rows
        ],
    }
