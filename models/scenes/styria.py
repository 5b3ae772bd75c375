"""Zach's flight over Styria: 2,049² heights over 120 by 120 km, and 1.4 million trees.

Zach, Mantler and Karner, "Time-critical rendering of discrete and continuous levels of detail",
section 4.  Two trees stand side by side: the terrain, a quadtree of patches of 33² vertices that
replace each other, and the forest, a quadtree without geometry above groups of at most 64 trees.  A
group is continuous, from some splats a tree to one, and below that to a fraction of its trees; each
tree is one draw call, as it is the unit that is set up.  A patch counts the vertices that are sent
in its strips.  The province's own heights are not public: these are made of smooth noise with
valleys, and trees stand on a jittered grid below the tree line where it is not too steep.
"""

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray
from ..continuous.splat_tree import SplatTree, splat_levels
from ..continuous.terrain import SAMPLE_BYTES, TerrainQuadtree, build_terrain
from ..meshes.geometry import Geometry
from ..scene.levels import LevelTable, count_rows
from ..scene.scene import ObjectTypes, Scene
from .parts.forest_groups import TreeGroups, group_trees
from .scene_registry import BundledScene

_SEED = 2002
WIDTH_M = 120_000.0
_SAMPLES = 2_049
CELL_M = WIDTH_M / (_SAMPLES - 1)
_TREES = 1_400_000
_PATCH = 32
_SPLATS = 512  # ours: of one tree at full resolution; the paper prints no number
_KNOTS = 6
_ERROR_CLASSES = 12  # of the patches of one depth, by measured error
_TREE_M = 12.0
_STEEPEST = 0.7
_TREE_LINE_M = 1_700.0
_WOODED = 0.5  # ours: cover from which a cell is forest; the paper's is classified from a satellite


def build_styria() -> tuple[Scene, Geometry]:
    """Return terrain and forest, south-west corner at the origin; there are no meshes."""
    heights = styria_heights()
    rng = np.random.default_rng((_SEED, 1))
    terrain = build_terrain(heights, CELL_M, patch=_PATCH)
    groups = group_trees(_plant(heights, rng), WIDTH_M)
    ground_types, ground_kind = _terrain_types(terrain)
    forest_types, forest_kind = _forest_types(groups, rng)
    types = _join(ground_types, forest_types)
    n = len(terrain.parent)
    parent = np.concatenate((terrain.parent, np.where(groups.parent < 0, -1, groups.parent + n)))
    center = np.concatenate((terrain.center_m, groups.center_m))
    kind = np.concatenate((ground_kind, forest_kind + len(ground_types.names)))
    return Scene.of("styria", types, kind, center, parent=parent), ()


def styria_heights() -> FloatArray:
    """Return heights in metres, (2,049, 2,049), rows south to north; 250 to about 2,500 m."""
    rng = np.random.default_rng(_SEED)
    frequency = np.fft.fftfreq(_SAMPLES)[:, None] ** 2 + np.fft.rfftfreq(_SAMPLES)[None, :] ** 2
    amplitude = np.where(frequency > 0.0, np.maximum(frequency, 1e-9) ** -0.95, 0.0)
    spectrum = amplitude * np.exp(2j * np.pi * rng.random(frequency.shape))
    relief = np.fft.irfft2(spectrum, s=(_SAMPLES, _SAMPLES))
    relief = (relief - relief.min()) / np.ptp(relief)
    # Higher towards the north-west, as the Alps are; valleys flatter than ridges.
    north, east = np.mgrid[0:_SAMPLES, 0:_SAMPLES] / (_SAMPLES - 1.0)
    rise = 0.35 + 0.65 * np.clip(0.5 * (north + 1.0 - east), 0.0, 1.0)
    return 250.0 + 2_600.0 * relief**1.6 * rise


def _plant(heights: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return places of the trees, (1.4 million, 3): a jittered grid over all that is forest."""
    wood = _forest(heights)
    # So fine that a few too many stand in the forest, of which some are left out at random.
    spacing = np.sqrt(wood.mean() / (1.01 * _TREES)) * (_SAMPLES - 1)
    side = int(np.ceil((_SAMPLES - 1) / spacing))
    places: list[FloatArray] = []
    for row in range(side):  # one row at a time: the grid has several times as many places
        u = (np.arange(side) + rng.random(side)) * ((_SAMPLES - 1) / side)
        v = (row + rng.random(side)) * ((_SAMPLES - 1) / side)
        kept = wood[v.astype(np.int64), u.astype(np.int64)]
        places.append(np.stack((u[kept], v[kept])))
    u, v = np.concatenate(places, axis=1)
    chosen = np.sort(rng.choice(len(u), _TREES, replace=False))
    u, v = u[chosen], v[chosen]
    column, row = u.astype(np.int64), v.astype(np.int64)
    south, north = (
        heights[at, column] * (1.0 - u % 1.0) + heights[at, column + 1] * (u % 1.0)
        for at in (row, row + 1)
    )
    return np.stack((u * CELL_M, v * CELL_M, south * (1.0 - v % 1.0) + north * (v % 1.0)), axis=1)


def _forest(heights: FloatArray) -> BoolArray:
    """Return which cells are forest, (2,048, 2,048): between valleys and tree line, not steep."""
    north_m: FloatArray = np.gradient(heights, CELL_M, axis=0)
    east_m: FloatArray = np.gradient(heights, CELL_M, axis=1)
    cover = np.clip(1.0 - np.hypot(north_m, east_m) / _STEEPEST, 0.0, 1.0)
    cover *= np.clip((_TREE_LINE_M - heights) / 300.0, 0.0, 1.0)
    cover *= np.clip((heights - 350.0) / 200.0, 0.0, 1.0)
    return cover[:-1, :-1] >= _WOODED


def _terrain_types(terrain: TerrainQuadtree) -> tuple[ObjectTypes, IntArray]:
    """Return types of patches, and the type of each.

    Patches of one depth and about one error share a type, with the greatest error and radius of
    them: one material draws them all, so that types as many as patches would be false costs.
    """
    kinds: list[tuple[str, float, float]] = []
    kind = np.zeros(len(terrain.parent), dtype=np.int64)
    for depth in range(int(terrain.depth.max()) + 1):
        here = np.flatnonzero(terrain.depth == depth)
        error = terrain.error_m[here]
        edges = np.quantile(error, np.linspace(0.0, 1.0, _ERROR_CLASSES + 1)[1:-1])
        classes = np.searchsorted(edges, error)
        for number in np.unique(classes):
            rows = here[classes == number]
            kind[rows] = len(kinds)
            radius, worst = terrain.radius_m[rows].max(), terrain.error_m[rows].max()
            kinds.append((f"patch-{depth}-{number}", float(radius), float(worst)))
    names, radius, worst = (list(column) for column in zip(*kinds, strict=True))
    n = len(names)
    counts = count_rows(
        n, draw_calls=1, vertices=terrain.sent_vertices, triangles=terrain.triangles
    )
    sizes = np.full(n, SAMPLE_BYTES * terrain.vertices)
    levels = LevelTable(np.arange(n + 1), counts, np.array(worst), sizes, np.zeros(n, np.bool_))
    return ObjectTypes(tuple(names), np.zeros((n, 3)), np.array(radius), levels), kind


def _forest_types(groups: TreeGroups, rng: np.random.Generator) -> tuple[ObjectTypes, IntArray]:
    """Return types of groups by their number of trees and size, and of empty nodes by size."""
    octave = np.ceil(2.0 * np.log2(groups.radius_m)).astype(np.int64)  # sizes 1.4 times apart
    pairs, kind = np.unique(np.stack((groups.trees, octave), 1), axis=0, return_inverse=True)
    kinds = [(trees, 2.0 ** (o / 2.0)) for trees, o in pairs.tolist()]
    tree = _splat_tree(rng)
    tables = {trees: splat_levels(tree, knots=_KNOTS, trees=trees) for trees in range(1, 65)}
    none = LevelTable(np.array([0, 1]), count_rows(1), np.zeros(1), np.zeros(1), np.zeros(1, bool))
    table = _stack([tables[trees] if trees else none for trees, _ in kinds])
    names = tuple(f"trees-{trees}-{radius:.0f}m" for trees, radius in kinds)
    radius = np.array([radius for _, radius in kinds])
    return ObjectTypes(names, np.zeros((len(kinds), 3)), radius, table), kind.ravel()


def _splat_tree(rng: np.random.Generator) -> SplatTree:
    """Return a spruce 12 m tall: leaf splats in a cone."""
    height = 1.0 - np.sqrt(rng.random(_SPLATS))  # as many as the cone is wide there
    angle = rng.uniform(0.0, 2.0 * np.pi, _SPLATS)
    out = 0.22 * _TREE_M * (1.0 - height) * np.sqrt(rng.uniform(0.5, 1.0, _SPLATS))
    z = _TREE_M * (0.12 + 0.88 * height)
    position = np.stack((out * np.cos(angle), out * np.sin(angle), z), axis=1)
    return SplatTree.of(position, np.full(_SPLATS, 0.15))


def _stack(tables: list[LevelTable]) -> LevelTable:
    begin = np.cumsum([0, *(len(table.error_m) for table in tables)])
    starts = [table.start[1:] + row for table, row in zip(tables, begin[:-1], strict=True)]
    return LevelTable(
        np.concatenate(([0], *starts)),
        np.concatenate([table.counts for table in tables]),
        np.concatenate([table.error_m for table in tables]),
        np.concatenate([table.bytes for table in tables]),
        np.concatenate([table.continuous for table in tables]),
    )


def _join(a: ObjectTypes, b: ObjectTypes) -> ObjectTypes:
    return ObjectTypes(
        a.names + b.names,
        np.concatenate((a.center_m, b.center_m)),
        np.concatenate((a.radius_m, b.radius_m)),
        _stack([a.levels, b.levels]),
    )


STYRIA = BundledScene(
    "terrain of 2,049² heights over 120 km, with 1.4 million trees in groups", build_styria
)
