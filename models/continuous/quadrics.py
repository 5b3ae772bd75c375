"""Quadric error of surfaces, in one pose or the sum of several.

The squared distance of a point to a plane is a product of ten coefficients of the plane and ten
monomials of the point.  So the error that a vertex makes in P poses of an animation is one product
of two rows of 10 P numbers, and errors of many vertex pairs are one call of numpy.
"""

import numpy as np

from ...base.arrays import FloatArray, IntArray

_BORDER_WEIGHT = 10.0
"""Weight of a border's planes over that of the surface; borders are few, and holes are seen."""

_PULL = 1e-6
"""Weight of the distance to a vertex itself over that to its planes, so that flat regions, where
every collapse is free, are thinned evenly instead of drawn together into fans."""


def point_monomials(poses: FloatArray) -> FloatArray:
    """Return ``x² xy xz x y² yz y z² z 1`` of each point, pose by pose: (P, V, 3) to (V, 10 P)."""
    ones = np.ones((*poses.shape[:2], 1))
    columns = _products(np.concatenate((poses, ones), axis=2))
    return np.ascontiguousarray(np.moveaxis(columns, 0, 1).reshape(poses.shape[1], -1))


def surface_quadrics(poses: FloatArray, faces: IntArray) -> FloatArray:
    """Return the quadric of each vertex, (V, 10 P), from P poses of the same triangles.

    Planes of triangles weigh as the root of their area.  An edge that does not join two triangles
    adds a plane through it, at a right angle to its triangle, that weighs as its length, so that
    borders hold their shape.

    Source: Garland and Heckbert, "Surface simplification using quadric error metrics" (1997),
    sections 3 to 6.  Difference: they weigh planes alike, which favours the greatest distance, and
    later by area, which favours the mean; the root is best in both together on real meshes.
    """
    result = np.zeros((poses.shape[1], 10 * len(poses)))
    border, corner = _border_edges(faces)
    for pose, points in enumerate(poses):
        columns = slice(10 * pose, 10 * pose + 10)
        a, b, c = (points[faces[:, i]] for i in range(3))
        normal = np.cross(b - a, c - a)
        length = np.linalg.norm(normal, axis=1, keepdims=True)
        unit = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
        # A cross product is twice the area.
        weight = np.sqrt(0.5 * length[:, 0])
        planes = _plane_quadrics(unit, a, weight)
        for i in range(3):
            # `add.at`, because plain indexing would add only one of a vertex's triangles.
            np.add.at(result[:, columns], faces[:, i], planes)
            for axis in np.eye(3):
                # The squared distance to a point is the sum of those to three planes through it.
                own = np.broadcast_to(axis, unit.shape)
                pull = _plane_quadrics(own, points[faces[:, i]], _PULL * weight)
                np.add.at(result[:, columns], faces[:, i], pull)
        start, end = faces[border, corner], faces[border, (corner + 1) % 3]
        edge = points[end] - points[start]
        # Normal of the plane through the edge that stands upright on its triangle.
        side = np.cross(edge, unit[border])
        size = np.linalg.norm(side, axis=1, keepdims=True)
        side = np.divide(side, size, out=np.zeros_like(side), where=size > 0)
        length_of_edge = np.linalg.norm(edge, axis=1)
        walls = _plane_quadrics(side, points[start], _BORDER_WEIGHT * length_of_edge)
        np.add.at(result[:, columns], start, walls)
        np.add.at(result[:, columns], end, walls)
    return result


def _border_edges(faces: IntArray) -> tuple[IntArray, IntArray]:
    """Return faces and first corners of the edges that do not join exactly two faces."""
    edges = np.stack((faces, np.roll(faces, -1, axis=1)), axis=2).reshape(-1, 2)
    edges = np.sort(edges, axis=1)
    _, index, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    rows = np.flatnonzero(count[index.ravel()] != 2)
    return rows // 3, rows % 3


def _plane_quadrics(normal: FloatArray, point: FloatArray, weight: FloatArray) -> FloatArray:
    """Return weighted quadrics of planes through the points, (n, 10)."""
    offset = -np.einsum("ij,ij->i", normal, point)
    # Products of two different values occur twice in the square of normal · x + offset.
    columns = _products(np.column_stack((normal, offset))) * weight[:, None]
    return columns * np.array([1.0, 2.0, 2.0, 2.0, 1.0, 2.0, 2.0, 1.0, 2.0, 1.0])


def _products(rows: FloatArray) -> FloatArray:
    """Return the ten products of the four values of each row."""
    first, second = np.triu_indices(4)
    return rows[..., first] * rows[..., second]
