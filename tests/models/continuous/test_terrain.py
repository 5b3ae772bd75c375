"""Terrain: the tree, bounds that hold every height, vertical errors by hand and by brute force."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench import InputError
from lodbench.models.continuous.terrain import SAMPLE_BYTES, TerrainQuadtree, build_terrain
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable, count_rows
from lodbench.models.scene.scene import ObjectTypes, Scene
from lodbench.policies.budgets.zach import Zach
from lodbench.policies.view import View


def hills(side: int) -> np.ndarray:
    """Return smooth heights of some metres with noise."""
    at = np.linspace(0.0, 1.0, side + 1)
    x, y = np.meshgrid(at, at)
    noise = np.random.default_rng(0).normal(0.0, 0.3, x.shape)
    return 20.0 * np.sin(5.0 * x) * np.cos(7.0 * y) + noise


@pytest.fixture(scope="module")
def terrain() -> TerrainQuadtree:
    """Return 33 by 33 heights, 10 m apart, in patches of 8 quads: three depths."""
    return build_terrain(hills(32), 10.0, patch=8)


def test_the_tree(terrain: TerrainQuadtree) -> None:
    """1, 4 and 16 patches; a child lies in the quarter of its parent."""
    assert np.bincount(terrain.depth).tolist() == [1, 4, 16]
    assert (terrain.parent < np.arange(21)).all()
    assert np.bincount(terrain.parent[1:]).tolist() == [4] * 5
    above = terrain.parent[1:]
    span = 320.0 / 2.0**terrain.depth
    off = np.abs(terrain.center_m[1:, :2] - terrain.center_m[above, :2])
    assert off == pytest.approx(np.repeat(span[1:, None] / 2.0, 2, axis=1))
    assert (terrain.triangles, terrain.vertices) == (128, 81)


def test_spheres_hold_their_heights(terrain: TerrainQuadtree) -> None:
    """Every height of a patch lies in its sphere."""
    heights = hills(32)
    for depth, center, radius in zip(
        terrain.depth, terrain.center_m, terrain.radius_m, strict=True
    ):
        cells = 32 >> int(depth)
        j, i = (round(float(middle) / 10.0 - cells / 2.0) for middle in center[:2])
        rows, columns = np.mgrid[i : i + cells + 1, j : j + cells + 1]
        points = np.stack((10.0 * columns, 10.0 * rows, heights[rows, columns]), axis=2)
        assert np.linalg.norm(points - center, axis=2).max() <= radius + 1e-9


def test_a_spike_by_hand() -> None:
    """One height of 6 m on a plane: the root, which skips it, errs by 6; the leaves by nothing."""
    heights = np.zeros((5, 5))
    heights[1, 3] = 6.0
    terrain = build_terrain(heights, 1.0, patch=2)
    assert terrain.error_m.tolist() == [6.0, 0.0, 0.0, 0.0, 0.0]
    heights[1, 3], heights[2, 2] = 0.0, 6.0  # the root has it: its slopes are off by half of it
    assert build_terrain(heights, 1.0, patch=2).error_m[0] == pytest.approx(3.0)


def test_errors_agree_with_brute_force(terrain: TerrainQuadtree) -> None:
    """The error of a patch is the worst over its heights, and at least that below it."""
    heights = hills(32)
    worst = np.zeros(21)
    for node, (depth, center) in enumerate(zip(terrain.depth, terrain.center_m, strict=True)):
        cells = 32 >> int(depth)
        step = cells // 8
        j, i = (round(float(middle) / 10.0 - cells / 2.0) for middle in center[:2])
        for row in range(i, i + cells + 1):
            for column in range(j, j + cells + 1):
                r, c = (min((v // step) * step, 32 - step) for v in (row, column))
                v, u = (row - r) / step, (column - c) / step
                low, high = heights[r, c], heights[r + step, c + step]
                side = heights[r, c + step] if u >= v else heights[r + step, c]
                first, second = (u, v) if u >= v else (v, u)
                drawn = low + first * (side - low) + second * (high - side)
                worst[node] = max(worst[node], abs(heights[row, column] - drawn))
    for node in range(20, 0, -1):
        worst[terrain.parent[node]] = max(worst[terrain.parent[node]], worst[node])
    assert terrain.error_m == pytest.approx(worst, abs=1e-9)
    assert (terrain.error_m[terrain.depth == 2] == 0.0).all()


def test_a_plane_needs_no_detail() -> None:
    """A slope is exact at any depth."""
    y, x = np.mgrid[0:33, 0:33]
    assert build_terrain(2.0 * x - 0.5 * y, 1.0, patch=8).error_m == pytest.approx(0.0, abs=1e-9)


def terrain_scene(name: str, terrain: TerrainQuadtree) -> Scene:
    """Return the quadtree as a scene: a node and a type of one level for each patch."""
    n = len(terrain.parent)
    counts = count_rows(n, draw_calls=1, vertices=terrain.vertices, triangles=terrain.triangles)
    sizes = np.full(n, SAMPLE_BYTES * terrain.vertices)
    levels = LevelTable(np.arange(n + 1), counts, terrain.error_m, sizes, np.zeros(n, np.bool_))
    names = tuple(f"patch-{i}" for i in range(n))
    types = ObjectTypes(names, np.zeros((n, 3)), terrain.radius_m, levels)
    return Scene.of(name, types, np.arange(n), terrain.center_m, parent=terrain.parent)


def test_zach_refines_the_terrain(
    terrain: TerrainQuadtree, make_view: Callable[..., View], make_scene: Callable[..., Scene]
) -> None:
    """With a budget for a patch the root is drawn; with one for all, the sixteen leaves."""
    costs = CostModel.of(0.0, {"vertices": 1.0})
    scene = terrain_scene("hills", terrain).with_costs(costs)
    above = Camera((160.0, 160.0, 900.0), (0.0, 0.0, 0.0, 1.0), 400, 400, np.pi / 3.0)
    drawn: list[int] = []
    for budget in (81.0, 16 * 81.0 + 1.0):
        policy = Zach()
        policy.reset(scene, budget)
        ids = policy.select(make_view(scene, above)).ids
        drawn.append(len(ids))
        assert len(set(terrain.depth[ids].tolist())) == 1
    assert drawn == [1, 16]


@pytest.mark.parametrize(
    ("shape", "patch", "cell_m"),
    [
        ((32, 33), 8, 1.0),
        ((32, 32), 8, 1.0),
        ((25, 25), 8, 1.0),
        ((5, 5), 8, 1.0),
        ((13, 13), 3, 1.0),
        ((17, 17), 0, 1.0),
        ((17, 17), 8, 0.0),
        ((17, 17), 8, np.nan),
        ((0, 0), 8, 1.0),
    ],
)
def test_fields_of_another_size_are_refused(
    shape: tuple[int, int], patch: int, cell_m: float
) -> None:
    """A field is square with patch · 2^k + 1 rows of a positive spacing, a patch a power of two."""
    with pytest.raises(InputError, match="expected"):
        build_terrain(np.zeros(shape), cell_m, patch=patch)


def test_heights_that_are_not_finite_are_refused() -> None:
    """A hole in the data is named by its row and column."""
    heights = np.zeros((17, 17))
    heights[3, 5] = np.nan
    with pytest.raises(InputError, match=r"heights.*\(3, 5\)"):
        build_terrain(heights, 1.0, patch=8)
