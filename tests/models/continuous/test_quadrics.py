"""Quadrics: squared distances to planes, walls at borders, and sums over poses."""

import numpy as np
import pytest

from lodbench.models.continuous.quadrics import point_monomials, surface_quadrics


def errors(poses: np.ndarray, faces: np.ndarray, vertex: int, at: np.ndarray) -> float:
    """Return the error of a vertex drawn at another place, the same in all poses."""
    moved = np.broadcast_to(at, (len(poses), 1, 3))
    return float(surface_quadrics(poses, faces)[vertex] @ point_monomials(moved)[0])


def test_distance_to_the_plane_weighs_as_the_root_of_the_area() -> None:
    """In the middle of a flat fan of area 4, height 3 costs 9 times four roots of 1."""
    rim = np.array([(1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, -1, 0)], dtype=float)
    poses = np.concatenate(([(0.0, 0.0, 0.0)], rim))[None]
    faces = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)])
    error = errors(poses, faces, 0, np.array((0.0, 0.0, 3.0)))
    assert error == pytest.approx(4 * 9.0, rel=1e-4)
    # Along the plane it costs next to nothing, but not nothing.
    assert 0.0 < errors(poses, faces, 0, np.array((0.5, 0.0, 0.0))) < 1e-5


def test_borders_are_walls() -> None:
    """A corner of a lone triangle pays ten times its edges' lengths for leaving them sideways."""
    poses = np.array([[(0, 0, 0), (2, 0, 0), (0, 1, 0)]], dtype=float)
    faces = np.array([(0, 1, 2)])
    error = errors(poses, faces, 0, np.array((0.0, -3.0, 0.0)))  # 3 off the edge of length 2
    assert error == pytest.approx(10.0 * 2.0 * 9.0, rel=1e-4)


def test_poses_add_up() -> None:
    """The error over two poses is the sum of that in each."""
    rng = np.random.default_rng(0)
    poses, at = rng.normal(size=(2, 5, 3)), rng.normal(size=3)
    faces = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)])
    both = errors(poses, faces, 0, at)
    single = [errors(poses[i : i + 1], faces, 0, at) for i in range(2)]
    assert both == pytest.approx(sum(single), rel=1e-9)
