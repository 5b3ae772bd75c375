"""What there is to draw of a level: without it, a level is a hole."""

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...base.predictors import LEVEL_PREDICTORS
from .levels import LevelTable
from .scene import Scene

_GEOMETRY = [LEVEL_PREDICTORS.index(name) for name in ("vertices", "triangles", "splats")]


def level_content(levels: LevelTable) -> FloatArray:
    """Return vertices, triangles and splats of each level together, (L,); 0 of a hole."""
    return levels.counts[:, _GEOMETRY].sum(axis=1)


def require_content(scene: Scene) -> None:
    """Raise InputError if no level of a scene has anything to draw: all policies would be alike."""
    if not level_content(scene.types.levels).any():
        raise InputError(
            f"scene {scene.name}: expected something to draw, got {len(scene):,} nodes without a "
            "triangle or splat; put the tiles' contents beside the tileset, or take another scene"
        )
