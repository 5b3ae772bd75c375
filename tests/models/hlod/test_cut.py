"""Cutting meshes along planes: areas, seams, neighbours."""

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from lodbench.models.hlod.cut import Planes, cut_along
from lodbench.models.meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface


def surface(points: np.ndarray, faces: np.ndarray, uv: np.ndarray | None = None) -> SurfaceMesh:
    """Return a mesh of one part."""
    return clean_surface("m", [MeshPart(points, faces, uv=uv, textured=uv is not None)])


def area(mesh: SurfaceMesh) -> float:
    """Return the sum of the areas of all triangles."""
    a, b, c = (mesh.positions[mesh.faces[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def open_edges(mesh: SurfaceMesh) -> int:
    """Return how many directed edges lack their opposite."""
    ends = np.stack((mesh.faces, np.roll(mesh.faces, -1, axis=1)), axis=2).reshape(-1, 2)
    there = {tuple(edge) for edge in ends.tolist()}
    return sum((b, a) not in there for a, b in there)


def test_one_triangle_in_three() -> None:
    """A plane at x = 1 through (0, 0), (2, 0), (0, 2): a tip of area 0.5 and a quad of 1.5."""
    mesh = surface(np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0]]), np.array([[0, 1, 2]]))
    cut, cell = cut_along(mesh, np.zeros(1, dtype=int), Planes(np.array([0]), np.array([[1.0]])))
    assert len(cut.faces) == 3
    assert cell.tolist() == [0, 0, 0]
    assert area(cut) == pytest.approx(2.0)
    right = cut.positions[cut.faces].mean(axis=1)[:, 0] > 1.0
    a, b, c = (cut.positions[cut.faces[right][0, i]] for i in range(3))
    assert np.cross(b - a, c - a) / 2.0 == pytest.approx([0.0, 0.0, 0.5])
    assert (cut.positions[3:, 0] == 1.0).all()


def test_a_plane_through_a_vertex_cuts_in_two() -> None:
    """The plane meets one corner and the opposite side."""
    mesh = surface(np.array([[-1.0, 0, 0], [1, 0, 0], [0, 1, 0]]), np.array([[0, 1, 2]]))
    cut, _ = cut_along(mesh, np.zeros(1, dtype=int), Planes(np.array([0]), np.array([[0.0]])))
    assert len(cut.faces) == 2
    assert area(cut) == pytest.approx(1.0)


def test_a_plane_along_vertices_cuts_nothing() -> None:
    """A grid whose columns lie on the planes stays as it is."""
    x, y = (a.ravel() for a in np.meshgrid(np.arange(5.0), np.arange(3.0), indexing="ij"))
    i = np.array([c * 3 + r for c in range(4) for r in range(2)])
    faces = np.concatenate((np.stack((i, i + 3, i + 4), 1), np.stack((i, i + 4, i + 1), 1)))
    mesh = surface(np.stack((x, y, 0 * x), 1), faces)
    planes = Planes(np.array([0]), np.array([[1.0, 2.0, 3.0]]))
    cut, _ = cut_along(mesh, np.zeros(16, dtype=int), planes)
    assert cut is mesh


def test_neighbours_in_other_cells_are_divided_too() -> None:
    """Only the left triangle's cell has a plane; the right one gets the vertex on their edge."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    mesh = surface(points, np.array([[0, 1, 2], [1, 3, 2]]))
    planes = Planes(np.array([0, 0]), np.array([[0.25], [9.0]]))
    left = (mesh.positions[mesh.faces] == 0.0).all(axis=2).any(axis=1)
    cut, cell = cut_along(mesh, np.where(left, 0, 1), planes)
    assert np.bincount(cell).tolist() == [3, 2]
    assert area(cut) == pytest.approx(1.0)
    middle = np.flatnonzero((cut.positions == (0.25, 0.75, 0.0)).all(axis=1))
    assert len(middle) == 1
    assert {int(c) for c in cell[(cut.faces == middle).any(axis=1)]} == {0, 1}


def test_texture_coordinates_follow() -> None:
    """Coordinates that equal positions before the cut equal them after it."""
    ball = trimesh.creation.icosphere(subdivisions=2)
    points = np.asarray(ball.vertices, dtype=float)
    mesh = surface(points, np.asarray(ball.faces), points[:, :2])
    planes = Planes(np.array([2]), np.array([[-0.31, 0.1, 0.77]]))
    cut, _ = cut_along(mesh, np.zeros(len(mesh.faces), dtype=int), planes)
    assert len(cut.faces) > len(mesh.faces)
    corner = cut.positions[cut.faces][:, :, :2]
    assert cut.uv[cut.uv_index] == pytest.approx(corner, abs=1e-12)
    assert len(np.unique(cut.uv, axis=0)) == len(cut.uv)


@given(st.integers(0, 2**32 - 1))
def test_a_closed_surface_stays_closed(seed: int) -> None:
    """Random cells with random planes: area, closedness and winding stay; nothing crosses."""
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=1)
    mesh = surface(np.asarray(ball.vertices, dtype=float), np.asarray(ball.faces))
    cells = int(rng.integers(1, 5))
    planes = Planes(rng.integers(0, 3, cells), np.sort(rng.uniform(-1, 1, (cells, 3)), axis=1))
    cut, cell = cut_along(mesh, rng.integers(0, cells, len(mesh.faces)), planes)
    assert area(cut) == pytest.approx(area(mesh), rel=1e-9)
    assert open_edges(cut) == 0
    for c in range(cells):
        corner = cut.positions[cut.faces[cell == c]][:, :, planes.axis[c]]
        for offset in planes.offset_m[c]:
            below = (corner < offset - 1e-8).any(axis=1)
            above = (corner > offset + 1e-8).any(axis=1)
            assert not (below & above).any()
