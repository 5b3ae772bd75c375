"""Contraction: topology, borders, orientation and the limits of a step."""

from collections.abc import Callable

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench import InputError
from lodbench.models.continuous.collapse import Contraction, contract
from lodbench.models.meshes.surface_mesh import MeshPart, SurfaceMesh, clean_surface


def replayed(mesh: SurfaceMesh, done: Contraction, steps: int) -> np.ndarray:
    """Return the triangles after some steps, each substitution done in turn."""
    faces = mesh.faces.copy()
    for step in range(steps):
        for vertex in np.flatnonzero(done.vertex_step == step):
            faces[faces == vertex] = done.target[vertex]
    a, b, c = faces.T
    return faces[(a != b) & (b != c) & (a != c)]


@pytest.mark.parametrize("share", [0.3, 0.7, 1.0])
def test_a_sphere_stays_a_sphere(ball: SurfaceMesh, share: float) -> None:
    """At any step the surface is closed, of Euler number 2, turned outward, of no double face."""
    done = contract(ball.positions[None], ball.faces)
    step = int(share * done.steps)
    faces = replayed(ball, done, step)
    mesh = trimesh.Trimesh(ball.positions, faces, process=False)
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0.0
    assert mesh.euler_number == 2
    assert len(np.unique(np.sort(faces, axis=1), axis=0)) == len(faces)
    assert len(faces) == (done.face_step >= step).sum()


def test_a_closed_mesh_ends_as_a_tetrahedron(ball: SurfaceMesh) -> None:
    """A step removes two triangles and one vertex until four of each are left."""
    done = contract(ball.positions[None], ball.faces)
    assert (done.face_step == done.steps).sum() == 4
    assert (done.vertex_step == done.steps).sum() == 4
    assert (np.bincount(done.face_step)[: done.steps] == 2).all()
    assert (np.bincount(done.vertex_step)[: done.steps] == 1).all()


def test_a_flat_sheet_keeps_its_outline(sheet: SurfaceMesh) -> None:
    """Only the border costs anything: down to ten triangles it is the whole square."""
    done = contract(sheet.positions[None], sheet.faces)
    left = np.array([(done.face_step >= step).sum() for step in range(done.steps + 1)])
    last = int(np.flatnonzero(left == 10)[0])
    for step in (done.steps // 2, last):
        mesh = trimesh.Trimesh(sheet.positions, replayed(sheet, done, step), process=False)
        assert mesh.area == pytest.approx(400.0)
        assert (mesh.face_normals[:, 2] > 0.0).all()


def test_the_cheapest_goes_first(make_grid: Callable[[str, np.ndarray], SurfaceMesh]) -> None:
    """In a plane with one spike, the spike is the last vertex inside to go."""
    height = np.zeros((9, 9))
    height[4, 4] = 3.0
    mesh = make_grid("spike", height)
    done = contract(mesh.positions[None], mesh.faces)
    spike = int(np.flatnonzero(mesh.positions[:, 2] == 3.0)[0])
    inside = np.all((mesh.positions[:, :2] > 0) & (mesh.positions[:, :2] < 8), axis=1)
    inside[spike] = False
    assert done.vertex_step[spike] > done.vertex_step[inside].max()


def test_fixed_vertices_stay(ball: SurfaceMesh) -> None:
    """What is fixed is never substituted."""
    fixed = np.zeros(len(ball.positions), dtype=np.bool_)
    fixed[::7] = True
    done = contract(ball.positions[None], ball.faces, fixed=fixed)
    assert (done.vertex_step[fixed] == done.steps).all()
    assert done.steps > 0


def test_non_manifold_edges_stay_curves() -> None:
    """Three fins on one edge of ten pieces keep the edge: it is thinned, its ends stay."""
    z = np.arange(11.0)
    points, faces = [np.stack((0 * z, 0 * z, z), axis=1)], list[tuple[int, int, int]]()
    for fin in range(3):
        turn = 2.0 * np.pi * fin / 3.0
        base = 11 * (fin + 1)
        points.append(np.stack((np.cos(turn) + 0 * z, np.sin(turn) + 0 * z, z), axis=1))
        for k in range(10):
            faces += [(k, k + 1, base + k), (k + 1, base + k + 1, base + k)]
    mesh = clean_surface("fins", [MeshPart(np.concatenate(points), np.array(faces))])
    done = contract(mesh.positions[None], mesh.faces)
    edge = (mesh.positions[:, :2] == 0.0).all(axis=1)
    ends = edge & np.isin(mesh.positions[:, 2], (0.0, 10.0))
    assert (done.vertex_step[edge] == done.steps).tolist() == ends[edge].tolist()
    assert edge[done.target[edge]].all()
    removed = np.bincount(done.face_step, minlength=done.steps)[: done.steps]
    assert removed.max() == 3  # a step along the edge


@settings(max_examples=40, deadline=None)
@given(
    triangles=st.lists(st.tuples(*[st.integers(0, 14)] * 3), min_size=1, max_size=120),
    seed=st.integers(0, 99),
)
def test_any_tangle_can_be_contracted(triangles: list[tuple[int, int, int]], seed: int) -> None:
    """Whatever the mesh, a step removes one to three triangles and every target outlives it."""
    points = np.random.default_rng(seed).normal(size=(15, 3))
    try:
        mesh = clean_surface("tangle", [MeshPart(points, np.array(triangles))])
    except InputError:
        return
    done = contract(mesh.positions[None], mesh.faces)
    removed = np.bincount(done.face_step, minlength=done.steps)[: done.steps]
    assert ((removed >= 1) & (removed <= 3)).all()
    gone = done.vertex_step < done.steps
    assert (done.vertex_step[done.target[gone]] > done.vertex_step[gone]).all()
    assert (done.face_step == done.steps).any()
    assert len(replayed(mesh, done, done.steps)) == (done.face_step == done.steps).sum()


def test_scale_and_place_do_not_matter(ball: SurfaceMesh) -> None:
    """Bumps in millimetres far from the origin contract as in metres about it."""
    bumps = 1.0 + 0.1 * np.random.default_rng(0).random(len(ball.positions))
    points = ball.positions * bumps[:, None]
    near = contract(points[None], ball.faces)
    far = contract((1e3 * points + 1e5)[None], ball.faces)
    assert (near.target == far.target).mean() > 0.95  # but for ties in rounding
