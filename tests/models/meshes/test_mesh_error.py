"""Measured error against shapes whose distance is known."""

import numpy as np
import pytest
import trimesh

from lodbench.base.arrays import FloatArray, IntArray
from lodbench.models.meshes.mesh_error import ErrorMeter, Sampling, nearest_faces

SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], dtype=float)
TWO = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32)


def sphere(subdivisions: int) -> tuple[FloatArray, IntArray]:
    """Return a unit sphere of 20 · 4^subdivisions triangles."""
    mesh = trimesh.creation.icosphere(subdivisions=subdivisions)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces, dtype=np.int32)


def test_parallel_squares() -> None:
    """A square lifted by 0.25 is 0.25 away."""
    meter = ErrorMeter(SQUARE, TWO, Sampling())
    assert meter.error_m(SQUARE + np.array((0, 0, 0.25)), TWO) == pytest.approx(0.25)
    assert meter.error_m(SQUARE, TWO) == pytest.approx(0.0, abs=1e-12)


def test_both_directions_count() -> None:
    """What one mesh has and the other lacks is found from either side."""
    tower = np.concatenate((SQUARE, [(0.5, 0.5, 3.0)]))
    faces = np.concatenate((TWO, [(0, 1, 4), (1, 2, 4)])).astype(np.int32)
    assert ErrorMeter(tower, faces, Sampling()).error_m(SQUARE, TWO) == pytest.approx(3.0)
    assert ErrorMeter(SQUARE, TWO, Sampling()).error_m(tower, faces) == pytest.approx(3.0)


def test_vertices_on_the_surface_do_not_hide_its_inside() -> None:
    """Two meshes with the same corners differ by the fold between them, found by samples."""
    folded = SQUARE + np.array([(0, 0, 0), (0, 0, 1), (0, 0, 0), (0, 0, 1)])
    other = np.array([(0, 1, 3), (1, 2, 3)], dtype=np.int32)
    # Along the diagonals' crossing one fold lies at height 0, the other at height 1; the nearest
    # points of the planes z = x ∓ y … are 1 / sqrt(3) away there at most.
    error = ErrorMeter(folded, TWO, Sampling(surface=20_000)).error_m(folded, other)
    assert 0.9 / np.sqrt(3) < error <= 1 / np.sqrt(3) + 1e-9


@pytest.mark.parametrize("coarse", [0, 1, 2])
def test_sphere_has_its_sagitta(coarse: int) -> None:
    """An inscribed sphere is away by 1 minus its smallest inner distance."""
    fine_points, fine_faces = sphere(4)
    points, faces = sphere(coarse)
    centers = points[faces].mean(axis=1)
    sagitta = 1.0 - float(np.linalg.norm(centers, axis=1).min())
    error = ErrorMeter(fine_points, fine_faces, Sampling()).error_m(points, faces)
    assert error == pytest.approx(sagitta, rel=0.02, abs=0.003)


def test_samples_are_seeded() -> None:
    """The same seed measures the same; another seed is close."""
    fine, coarse = sphere(3), sphere(1)
    errors = [ErrorMeter(*fine, Sampling(seed=s)).error_m(*coarse) for s in (0, 0, 1)]
    assert errors[0] == errors[1]
    assert errors[2] == pytest.approx(errors[0], rel=0.02)


def test_vertex_limit_spreads_over_the_order() -> None:
    """With few vertices allowed, the far end of the vertex order is still looked at."""
    line = np.array([(i, i % 2, 0.0) for i in range(200)], dtype=float)
    strip = np.array([(i, i + 1, i + 2) for i in range(198)], dtype=np.int32)
    bent = line.copy()
    bent[-1, 2] = 5.0
    meter = ErrorMeter(bent, strip, Sampling(vertices=10, surface=0))
    assert meter.error_m(line, strip) == pytest.approx(5.0)


def test_far_points_are_measured_in_small_chunks() -> None:
    """A level far from a dense mesh, whose candidates are all of its faces, is measured whole."""
    points, faces = sphere(5)
    far = SQUARE * 0.1 + (10.0, 0.0, 0.0)
    meter = ErrorMeter(points, faces, Sampling(vertices=100, surface=400))
    assert meter.error_m(far, TWO) == pytest.approx(11.0, abs=0.01)


def test_nearest_faces() -> None:
    """Points above the two halves of a square find their triangle."""
    found = nearest_faces(SQUARE, TWO, np.array([(0.9, 0.1, 1.0), (0.1, 0.9, -1.0)]))
    assert found.tolist() == [0, 1]
