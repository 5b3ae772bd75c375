"""The totally ordered mesh: prefixes, extraction at any count, chains and restart lists."""

import numpy as np
import pytest
from model_tables import traversal_overhead

from lodbench import InputError
from lodbench.models.continuous.collapse import Contraction, contract
from lodbench.models.continuous.ordered_mesh import OrderedMesh, order_mesh, substitute
from lodbench.models.meshes.surface_mesh import SurfaceMesh


def by_hand(vertex_step: list[int], target: list[int], face_step: list[int]) -> Contraction:
    """Return a contraction of two steps."""
    return Contraction(2, np.array(vertex_step), np.array(target), np.array(face_step))


@pytest.fixture(scope="module")
def done(ball: SurfaceMesh) -> Contraction:
    """Return the contraction of the ball."""
    return contract(ball.positions[None], ball.faces)


@pytest.fixture(scope="module")
def ordered(ball: SurfaceMesh, done: Contraction) -> OrderedMesh:
    """Return the ball in order, with restart lists."""
    return order_mesh(ball.faces, done)


def test_a_strip_by_hand() -> None:
    """Four triangles in a row; vertex 0 goes to 1, then 1 to 2."""
    faces = np.array([(0, 1, 2), (1, 3, 2), (2, 3, 4), (3, 5, 4)])
    done = by_hand([0, 1, 2, 2, 2, 2], [1, 2, 2, 3, 4, 5], [0, 1, 2, 2])
    mesh = order_mesh(faces, done, max_overhead=None)
    assert mesh.vertex_source.tolist() == [2, 3, 4, 5, 1, 0]
    assert mesh.face_source.tolist() == [2, 3, 1, 0]
    assert mesh.target.tolist() == [0, 1, 2, 3, 0, 4]
    assert mesh.vertices_after.tolist() == [6, 5, 4]
    assert mesh.faces_after.tolist() == [4, 3, 2]
    assert mesh.vertex_source[mesh.extract(3)].tolist() == [[2, 3, 4], [3, 5, 4], [1, 3, 2]]
    assert traversal_overhead(mesh).tolist() == [0.0, 0.0, 0.0]  # no chain outlives its triangle


def test_a_chain_by_hand() -> None:
    """A triangle whose corner moves twice draws three vertices and visits one, then two more."""
    faces = np.array([(0, 8, 9), (0, 1, 7), (1, 2, 7)])
    target = [1, 2, 2, 3, 4, 5, 6, 7, 8, 9]
    done = by_hand([0, 1, *[2] * 8], target, [2, 0, 1])
    mesh = order_mesh(faces, done, max_overhead=None)
    assert traversal_overhead(mesh).tolist() == pytest.approx([0.0, 1 / 6, 2 / 3])
    bounded = order_mesh(faces, done, max_overhead=0.5)
    assert [restart.step for restart in bounded.restarts] == [0, 2]
    assert traversal_overhead(bounded).tolist() == pytest.approx([0.0, 1 / 6, 0.0])
    for count in (1, 2, 3):
        assert (bounded.extract(count) == mesh.extract(count)).all()


def test_every_count_is_delivered_within_two(ball: SurfaceMesh, ordered: OrderedMesh) -> None:
    """From the fewest to all, at most two triangles short, with valid corners of area."""
    for count in range(int(ordered.faces_after[-1]), len(ball.faces) + 1):
        faces = ordered.extract(count)
        assert count - 2 <= len(faces) <= count
        active = ordered.vertices_after[ordered.step_of(count)]
        assert faces.min() >= 0
        assert faces.max() < active
        a, b, c = faces.T
        assert ((a != b) & (b != c) & (c != a)).all()


def test_full_resolution_is_the_mesh(ball: SurfaceMesh, ordered: OrderedMesh) -> None:
    """At full resolution all triangles are drawn as they came, without a single substitution."""
    faces = ordered.vertex_source[ordered.extract(len(ball.faces))]
    assert (faces == ball.faces[ordered.face_source]).all()
    assert traversal_overhead(ordered)[0] == 0.0


def test_restart_lists_change_work_but_not_meshes(
    ball: SurfaceMesh, done: Contraction, ordered: OrderedMesh
) -> None:
    """With and without restart lists the same triangles come out at every step."""
    plain = order_mesh(ball.faces, done, max_overhead=None)
    assert len(plain.restarts) == 1
    assert len(ordered.restarts) > 3
    for count in ordered.faces_after[::17].tolist():
        assert (plain.extract(count) == ordered.extract(count)).all()


def test_overhead_is_what_the_walk_visits(ordered: OrderedMesh) -> None:
    """The overhead at a step is the links that the extraction there walks, over the corners."""
    overhead = traversal_overhead(ordered)
    for step in range(0, ordered.steps + 1, 13):
        faces = ordered.restart_at(step).faces[: ordered.faces_after[step]].copy()
        links = substitute(faces, ordered.target, int(ordered.vertices_after[step]))
        assert overhead[step] == pytest.approx(links / faces.size)


@pytest.mark.parametrize("limit", [0.1, 1 / 3, 1.0])
def test_overhead_is_bounded(ball: SurfaceMesh, done: Contraction, limit: float) -> None:
    """The bound holds at every step, and a lower one takes more restart lists."""
    bounded = order_mesh(ball.faces, done, max_overhead=limit)
    looser = order_mesh(ball.faces, done, max_overhead=2 * limit)
    assert traversal_overhead(bounded).max() <= limit
    assert len(bounded.restarts) > len(looser.restarts)


def test_published_chains_grow_as_the_logarithm(ball: SurfaceMesh, done: Contraction) -> None:
    """Four corners move in a step that leaves 2 n triangles: 2/3 ln(1 / r) links a corner."""
    plain = order_mesh(ball.faces, done, max_overhead=None)
    overhead = traversal_overhead(plain)
    for share in (0.5, 0.25, 0.1):
        step = plain.step_of(round(share * len(ball.faces)))
        assert overhead[step] == pytest.approx(2 / 3 * np.log(1 / share), rel=0.25)


@pytest.mark.parametrize("count", [0, 3, 1_281, -5])
def test_counts_out_of_range_are_refused(ordered: OrderedMesh, count: int) -> None:
    """Fewer than the coarsest or more than the full mesh's triangles cannot be had."""
    with pytest.raises(InputError, match=f"expected 4 to 1280, got {count}"):
        ordered.step_of(count)


@pytest.mark.parametrize("limit", [0.0, -1.0, np.nan])
def test_a_bound_that_no_list_meets_is_refused(
    ball: SurfaceMesh, done: Contraction, limit: float
) -> None:
    """A bound of 0 would need a list for every step."""
    with pytest.raises(InputError, match="max_overhead: expected above 0"):
        order_mesh(ball.faces, done, max_overhead=limit)
