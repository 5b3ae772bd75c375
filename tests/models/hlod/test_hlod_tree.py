"""Trees of pieces: counts, areas, gaps, benefits, and real meshes."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from lodbench import InputError
from lodbench.models.hlod.hlod_scene import hlod_scene, place_trees
from lodbench.models.hlod.hlod_tree import Hlod, HlodOptions, build_hlod
from lodbench.models.layouts.scene_builder import PlacementOptions
from lodbench.models.meshes.mesh_error import Sampling
from lodbench.models.meshes.mesh_file import load_mesh
from lodbench.models.meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface
from lodbench.models.scene.tree import Tree

FEW = Sampling(vertices=500, surface=200)


@pytest.fixture(scope="module")
def column() -> SurfaceMesh:
    """Return a closed, bumpy column of 20,480 triangles, 6 m tall, half of it textured."""
    ball = trimesh.creation.icosphere(subdivisions=5)
    points = np.asarray(ball.vertices, dtype=float)
    bump = 1.0 + 0.05 * np.sin(9.0 * points[:, :1])
    points = np.column_stack((points[:, :2] * bump, 3.0 * points[:, 2]))
    faces = np.asarray(ball.faces)
    upper = points[faces].mean(axis=1)[:, 2] > 0.0
    parts = [
        MeshPart(points, faces[upper], 0, textured=True, uv=points[:, :2]),
        MeshPart(points, faces[~upper], 1, textured=False),
    ]
    return clean_surface("column", parts, texture_bytes=1e6)


@pytest.fixture(scope="module")
def tree(column: SurfaceMesh) -> Hlod:
    """Return its tree: 20,480 / 900 = 22.8, then 5.7 and 1.4 times simplified, then full."""
    return build_hlod(column, HlodOptions(), FEW)


def pieces_at(tree: Hlod, depth: int) -> tuple[np.ndarray, np.ndarray]:
    """Return all pieces of a depth as one mesh, with equal positions merged and nothing else."""
    rows = np.flatnonzero(tree.depth == depth)
    points = np.concatenate([tree.meshes[i].vertices for i in rows])
    start = np.cumsum([0, *(len(tree.meshes[i].vertices) for i in rows)])
    faces = np.concatenate([tree.meshes[i].faces + s for i, s in zip(rows, start, strict=False)])
    merged, index = np.unique(points, axis=0, return_inverse=True)
    return merged.astype(float), index.ravel()[faces]


def open_length(points: np.ndarray, faces: np.ndarray) -> float:
    """Return the length of all edges that have a triangle on one side only."""
    ends = np.sort(np.stack((faces, np.roll(faces, -1, axis=1)), axis=2), axis=2).reshape(-1, 2)
    edge, count = np.unique(ends, axis=0, return_counts=True)
    a, b = points[edge[count == 1]].transpose(1, 0, 2)
    return float(np.linalg.norm(a - b, axis=1).sum())


def area(points: np.ndarray, faces: np.ndarray) -> float:
    """Return the area of a mesh."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def test_levels_by_hand() -> None:
    """Factors fall by four until they are below one; a small mesh is one node."""
    assert HlodOptions().targets(20_480) == pytest.approx([22.756, 5.689, 1.422, 1.0], abs=1e-3)
    assert HlodOptions().targets(899) == [1.0]
    assert HlodOptions(max_levels=2).targets(20_480) == pytest.approx([22.756, 1.0], abs=1e-3)
    assert HlodOptions(level_factor=2, desired_triangles=100).targets(300) == [3.0, 1.5, 1.0]


def test_each_level_has_its_share(tree: Hlod) -> None:
    """900 triangles in all at the top, four times as many a level below, plus those of cuts."""
    assert np.bincount(tree.depth)[:3].tolist() == [1, 4, 16]
    assert 48 < np.bincount(tree.depth)[3] <= 64  # cells inside the hollow column have no node
    total = [tree.counts[tree.depth == d, 2].sum() for d in range(4)]
    assert total[0] == 900.0
    assert 3_600 <= total[1] < 5_000
    assert 14_400 <= total[2] < 20_480
    assert total[3] >= 20_480


def test_no_gaps_at_equal_level(column: SurfaceMesh, tree: Hlod) -> None:
    """The pieces of each level close up to a closed surface, to the last bit of float32."""
    for depth in range(4):
        assert open_length(*pieces_at(tree, depth)) == 0.0
    whole = area(column.positions, column.faces)
    assert area(*pieces_at(tree, 3)) == pytest.approx(whole, rel=1e-6)


def test_pieces_lie_between_the_planes_of_their_parent(tree: Hlod) -> None:
    """The column is cut across its length, into four parts of equal length."""
    child = np.flatnonzero(tree.parent == 0)
    height = 6.0 / 4.0
    assert tree.low_m[child, 2].min() == pytest.approx(-3.0, abs=0.2)
    inner = np.sort(tree.high_m[child, 2])[:3]
    assert inner == pytest.approx([-3.0 + height, 0.0, height], abs=0.02)


def test_errors_fall_with_depth(tree: Hlod) -> None:
    """All nodes of a level share its measured error; that of the full mesh is 0."""
    by_depth = [np.unique(tree.error_m[tree.depth == d]) for d in range(4)]
    assert all(len(errors) == 1 for errors in by_depth)
    assert (np.diff([float(errors[0]) for errors in by_depth]) <= 0.0).all()
    assert by_depth[0] > 0.0
    assert by_depth[3] == 0.0


def test_bytes(tree: Hlod) -> None:
    """32 a vertex and 12 a triangle."""
    for mesh, size in zip(tree.meshes, tree.bytes, strict=True):
        assert size == 32 * len(mesh.vertices) + 12 * len(mesh.faces)


def test_textures_shrink_with_their_level(tree: Hlod) -> None:
    """All of the texture at full detail, a 22.8th of it at the top; plain nodes have none."""
    sums = [tree.counts[tree.depth == d, 6].sum() for d in range(4)]
    assert sums == pytest.approx([1e6 / 22.756, 1e6 / 5.689, 1e6 / 1.422, 1e6], rel=1e-3)
    low = tree.high_m[:, 2] < -0.1
    assert (tree.counts[low, 6] == 0.0).all()
    assert (tree.counts[low, 4] == 0.0).all()
    assert 0.45 < tree.counts[0, 4] / tree.counts[0, 2] < 0.55


def test_surfaces_and_normals(tree: Hlod) -> None:
    """At each depth areas sum to the level's; pieces of a round column face away from its axis."""
    for depth in range(4):
        rows = tree.depth == depth
        assert tree.surface_m2[rows].sum() == pytest.approx(area(*pieces_at(tree, depth)), rel=1e-6)
    assert np.linalg.norm(tree.normal[0]) < 1e-6  # a closed surface faces nowhere
    leaf = tree.depth == 3
    assert np.linalg.norm(tree.normal[leaf], axis=1) == pytest.approx(1.0)
    middle = (tree.low_m + tree.high_m)[leaf] / 2.0
    outward = (tree.normal[leaf] * middle).sum(axis=1)
    assert (outward > 0.0).mean() > 0.9


def test_spheres_hold_all_that_is_below(tree: Hlod) -> None:
    """Who culls a node by its sphere culls nothing that is in view."""
    scene, _ = hlod_scene(
        "one", [tree], np.zeros(1, int), np.zeros((1, 3)), np.zeros(1), np.ones(1)
    )
    child = np.flatnonzero(scene.parent >= 0)
    parent = scene.parent[child]
    gap_m = np.linalg.norm(scene.center_m[child] - scene.center_m[parent], axis=1)
    assert (gap_m + scene.radius_m[child] <= scene.radius_m[parent] * (1.0 + 1e-12)).all()


def test_copies_in_a_scene(tree: Hlod) -> None:
    """Two copies, one turned and half as large: roots first, children below their own root."""
    scene, geometry = hlod_scene(
        "two",
        [tree],
        np.array([0, 0]),
        np.array([[0.0, 0.0, 0.0], [50.0, 0.0, 0.0]]),
        np.array([0.0, np.pi / 2]),
        np.array([1.0, 0.5]),
    )
    nodes = len(tree.meshes)
    assert len(scene) == 2 * nodes
    assert len(geometry) == nodes
    assert scene.roots.tolist() == [0, 1]
    structure = Tree(scene)
    assert np.bincount(structure.depth).tolist() == (2 * np.bincount(tree.depth)).tolist()
    root = structure.first_in(scene.parent < 0, np.arange(2, 2 * nodes))
    near = np.linalg.norm(scene.center_m[2:] - scene.center_m[root], axis=1)
    assert (near <= scene.radius_m[root] * 1.1).all()


def test_layouts_keep_trees_apart(tree: Hlod) -> None:
    """Six trees on a grid, their roots' boxes not nearer than the spacing."""
    options = PlacementOptions("grid", 6, spacing_m=2.0)
    scene, _ = place_trees("six", [tree], options, np.random.default_rng(0))
    plan = scene.center_m[scene.roots, :2]
    gap = np.linalg.norm(plan[:, None] - plan[None], axis=2) + 99.0 * np.eye(6)
    assert gap.min() > 2.0 + 2.0 * 1.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"desired_triangles": 0}, "desired triangles"),
        ({"level_factor": 1}, "level factor"),
        ({"max_levels": 9}, "HLOD levels"),
    ],
)
def test_options_out_of_range(options: dict[str, int], message: str) -> None:
    """Each is refused by name."""
    with pytest.raises(InputError, match=message):
        HlodOptions(**options)


@pytest.mark.realdata
@pytest.mark.parametrize(
    "name",
    [
        "CesiumMilkTruck.glb",
        "cow.obj",
        "fandisk.obj",
        "homer.obj",
        "rocker-arm.obj",
        "spot.obj",
        pytest.param("stanford-bunny.obj", marks=pytest.mark.slow),
        "suzanne.obj",
        "teapot.obj",
    ],
)
def test_real_meshes(name: str, data_dir: Path) -> None:
    """Leaves have the area and the open edges of the mesh; levels close where it does."""
    mesh = load_mesh(data_dir / "meshes" / name)
    tree = build_hlod(mesh, HlodOptions(desired_triangles=600), FEW)
    deepest = int(tree.depth.max())
    points, faces = pieces_at(tree, deepest)
    assert area(points, faces) == pytest.approx(area(mesh.positions, mesh.faces), rel=1e-3)
    single = mesh.positions.astype(np.float32).astype(float)
    merged, index = np.unique(single, axis=0, return_inverse=True)
    before = open_length(merged, index.ravel()[mesh.faces])
    size = float(np.ptp(mesh.positions, axis=0).max())
    assert open_length(points, faces) == pytest.approx(before, rel=1e-5, abs=1e-9 * size)
    if before == 0.0:
        for depth in range(deepest):
            assert open_length(*pieces_at(tree, depth)) < 1e-9 * size
