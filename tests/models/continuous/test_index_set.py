"""Index sets changed in place: what is drawn, and the operations counted."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from index_set import ExtractionWork, IndexSet

from lodbench.models.continuous.collapse import Contraction, contract
from lodbench.models.continuous.ordered_mesh import OrderedMesh, order_mesh
from lodbench.models.meshes.surface_mesh import SurfaceMesh


def by_hand(vertex_step: list[int], target: list[int], face_step: list[int]) -> Contraction:
    """Return a contraction of two steps."""
    return Contraction(2, np.array(vertex_step), np.array(target), np.array(face_step))


@pytest.fixture(scope="module")
def ordered(ball: SurfaceMesh) -> OrderedMesh:
    """Return the ball in order."""
    return order_mesh(ball.faces, contract(ball.positions[None], ball.faces))


@settings(max_examples=40, deadline=None)
@given(counts=st.lists(st.integers(4, 1_280), min_size=1, max_size=8))
def test_any_walk_draws_what_extraction_does(ordered: OrderedMesh, counts: list[int]) -> None:
    """Whatever came before, the set holds the mesh of the count, and the writes explain it."""
    indices = IndexSet(ordered)
    for count in counts:
        before = indices.faces.copy()
        work = indices.change(count)
        after = indices.faces
        assert (after == ordered.extract(count)).all()
        kept = min(len(before), len(after))
        rewritten = np.count_nonzero(before[:kept] != after[:kept])
        assert work.index_writes == rewritten + 3 * (len(after) - kept)
        assert work.vertices_visited >= 3 * len(after)


def test_operations_by_hand() -> None:
    """Two triangles go and a corner moves: one index is written; back, the triangles come whole."""
    faces = np.array([(0, 8, 9), (0, 1, 7), (1, 2, 7)])
    target = [1, 2, 2, 3, 4, 5, 6, 7, 8, 9]
    done = by_hand([0, 1, *[2] * 8], target, [2, 0, 1])
    indices = IndexSet(order_mesh(faces, done, max_overhead=None))
    # Three corners drawn, and two links of the one chain.
    assert indices.change(1) == ExtractionWork(3, 1, 5)
    # Two triangles of three indices, and the corner back; nine corners, no chain.
    assert indices.change(3) == ExtractionWork(3, 7, 9)
    assert indices.change(3) == ExtractionWork(0, 0, 9)


def test_a_small_change_writes_little(ordered: OrderedMesh) -> None:
    """A step of a closed mesh removes two triangles and moves one corner of two to five others."""
    indices = IndexSet(ordered)
    writes = [indices.change(count).index_writes for count in range(1_278, 700, -2)]
    assert 2.0 < np.mean(writes) < 5.0
