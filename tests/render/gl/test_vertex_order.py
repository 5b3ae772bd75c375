"""Order of triangles and vertices: what is drawn stays the same, and the cache misses less."""

from collections import deque
from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from lodbench.models.meshes.geometry import LevelMesh
from lodbench.render.gl.vertex_order import cache_friendly


def triangles(mesh: LevelMesh, part: int) -> list[tuple[Any, ...]]:
    """Return a part's triangles as all that is known of their corners, in no order."""
    assert mesh.uv is not None
    corners = np.concatenate((mesh.vertices, mesh.normals, mesh.uv), axis=1)
    faces = mesh.faces[mesh.part_start[part] : mesh.part_start[part + 1]]
    found: list[tuple[Any, ...]] = []
    for face in corners[faces].tolist():
        first = face.index(min(face))  # whichever corner is named first
        found.append(tuple(tuple(face[(first + i) % 3]) for i in range(3)))
    return sorted(found)


def grid(side: int, rng: np.random.Generator) -> LevelMesh:
    """Return a flat grid whose vertices and triangles are shuffled."""
    y, x = np.mgrid[: side + 1, : side + 1]
    vertices = np.column_stack((x.ravel(), y.ravel(), np.zeros(x.size))).astype(np.float32)
    at = (np.arange(side)[:, None] * (side + 1) + np.arange(side)).ravel()
    faces = np.concatenate(
        (np.stack((at, at + 1, at + side + 2), 1), np.stack((at, at + side + 2, at + side + 1), 1))
    )
    place = rng.permutation(len(vertices))
    faces = rng.permutation(place[faces])
    vertices = vertices[np.argsort(place)]
    start = np.array((0, len(faces) // 3, len(faces)))
    return LevelMesh(vertices, np.ones_like(vertices), faces, start, vertices[:, :2])


def misses(mesh: LevelMesh) -> float:
    """Return how many vertices a triangle misses in a first-in-first-out cache of 16."""
    cache: deque[int] = deque(maxlen=16)
    missed = 0
    for vertex in mesh.faces.ravel().tolist():
        if vertex not in cache:
            cache.append(vertex)
            missed += 1
    return missed / len(mesh.faces)


@given(
    faces=st.lists(st.tuples(*[st.integers(0, 11)] * 3), min_size=1, max_size=30),
    cut=st.floats(0.0, 1.0),
    seed=st.integers(0, 99),
)
def test_the_same_triangles_in_the_same_parts(
    faces: list[tuple[int, int, int]], cut: float, seed: int
) -> None:
    """Any soup keeps its triangles, their winding and attributes, and drops unused vertices."""
    rng = np.random.default_rng(seed)
    vertices, normals = rng.random((2, 12, 3), dtype=np.float32)
    start = np.array((0, round(cut * len(faces)), len(faces)))
    mesh = LevelMesh(vertices, normals, np.array(faces), start, vertices[:, 1:])
    ordered = cache_friendly(mesh)
    assert ordered.part_start.tolist() == mesh.part_start.tolist()
    for part in range(2):
        assert triangles(ordered, part) == triangles(mesh, part)
    assert len(ordered.vertices) == len(np.unique(mesh.faces))


def test_a_shuffled_grid_misses_less() -> None:
    """From nearly three vertices a triangle to little more than half as many."""
    mesh = grid(24, np.random.default_rng(3))
    assert misses(mesh) > 2.5
    assert misses(cache_friendly(mesh)) < 0.6 * misses(mesh)


def test_vertices_come_in_the_order_of_their_use() -> None:
    """So that they are read from memory one after another."""
    ordered = cache_friendly(grid(8, np.random.default_rng(4)))
    first = np.unique(ordered.faces.ravel(), return_index=True)[1]
    assert (np.diff(first) > 0).all()
