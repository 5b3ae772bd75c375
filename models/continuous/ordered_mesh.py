"""The totally ordered mesh: every resolution of a mesh in one vertex and one triangle list."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from ...base.arrays import FloatArray, IntArray, freeze
from ...base.errors import InputError, require_between
from .collapse import Contraction


@dataclass(frozen=True, slots=True)
class Restart:
    """The triangles after some steps, their corners active there; (T, 3) int32."""

    step: int
    faces: Annotated[IntArray, np.int32, "T", 3]

    def __post_init__(self) -> None:
        freeze(self, "restart", T=len(self.faces))


@dataclass(frozen=True, slots=True)
class OrderedMesh:
    """A mesh of V drawn vertices and F triangles and the S steps that contract it.

    Vertices and triangles stand in the order of the step that removes them, last removed first, so
    that what is active after any number of steps is a prefix of both lists.  A corner whose vertex
    is not active is drawn by the first active vertex of its chain of substitutes.

    Source: Gobbetti and Bouvier, "Time-critical multiresolution rendering of large complex models"
    (2000), section 6.  Difference: restart lists, which hold the triangles of some later steps with
    their chains already walked.  With the list of step 0 alone, as published, chains grow as
    resolution falls; each further list bounds them anew.

    Attributes
    ----------
    vertex_source : (V,) int32
        Row of each vertex in the mesh that was ordered.
    face_source : (F,) int32
        Row of each triangle there.
    target : (V,) int32
        Substitute of each vertex, always an earlier one; itself if it is never removed.
    vertices_after, faces_after : (S + 1,) int32
        Active vertices and triangles after each number of steps, falling.
    restarts : tuple of Restart
        By step, the first at step 0.
    """

    vertex_source: Annotated[IntArray, np.int32, "V"]
    face_source: Annotated[IntArray, np.int32, "F"]
    target: Annotated[IntArray, np.int32, "V"]
    vertices_after: Annotated[IntArray, np.int32, "S"]
    faces_after: Annotated[IntArray, np.int32, "S"]
    restarts: tuple[Restart, ...]

    def __post_init__(self) -> None:
        freeze(self, "ordered", V=len(self.target), F=len(self.face_source), S=self.steps + 1)

    @property
    def steps(self) -> int:
        """Steps from the full mesh to the coarsest."""
        return len(self.faces_after) - 1

    def step_of(self, triangles: int) -> int:
        """Return the fewest steps that leave at most this many triangles.

        A step removes one to three, so that at most two fewer are left.

        Raises `InputError` if the number is not between the coarsest and the full mesh's.
        """
        least, full = int(self.faces_after[-1]), int(self.faces_after[0])
        require_between(triangles, least, full, "triangles")
        # Counts fall, and search wants them to rise.
        return int(np.searchsorted(-self.faces_after, -triangles))

    def restart_at(self, step: int) -> Restart:
        """Return the last restart list at or before a step."""
        return next(r for r in reversed(self.restarts) if r.step <= step)

    def extract(self, triangles: int) -> IntArray:
        """Return the corners of the mesh of that many triangles (see `step_of`), (T, 3) int32."""
        step = self.step_of(triangles)
        faces = self.restart_at(step).faces[: self.faces_after[step]].copy()
        substitute(faces, self.target, int(self.vertices_after[step]))
        return faces


def order_mesh(
    drawn: IntArray, contraction: Contraction, *, max_overhead: float | None = 1.0 / 3.0
) -> OrderedMesh:
    """Sort the drawn vertices and triangles of a mesh by the step that removes them.

    Parameters
    ----------
    drawn : (F, 3)
        Drawn vertices of the corners, as contracted.
    max_overhead : float, optional
        A restart list is made wherever the traversal overhead would pass this; None makes the
        published structure.  Above 0.
    """
    if max_overhead is not None and not max_overhead > 0.0:
        raise InputError(f"max_overhead: expected above 0, got {max_overhead}")
    # What is never removed has step S, so it comes first: the coarsest mesh heads both lists.
    # Stable, so that the same mesh is ordered alike on every machine.
    by_vertex = np.argsort(-contraction.vertex_step, kind="stable")
    by_face = np.argsort(-contraction.face_step, kind="stable")
    rank = np.empty(len(by_vertex), dtype=np.int32)
    rank[by_vertex] = np.arange(len(by_vertex))
    # A substitute outlives what it stands for, so it stands earlier: chains lead down the list
    # and end.
    target = rank[contraction.target[by_vertex]]
    vertices_after = _active(contraction.vertex_step, contraction.steps)
    faces_after = _active(contraction.face_step, contraction.steps)
    restarts = [Restart(0, rank[drawn[by_face]])]
    while max_overhead is not None:
        last = restarts[-1]
        over = overhead_from(last, target, vertices_after, faces_after) > max_overhead
        if not over.any():
            break
        # A fresh list has no overhead at its own step, so the next one comes later: this ends.
        step = last.step + int(over.argmax())
        faces = last.faces[: faces_after[step]].copy()
        substitute(faces, target, int(vertices_after[step]))
        restarts.append(Restart(step, faces))
    return OrderedMesh(by_vertex, by_face, target, vertices_after, faces_after, tuple(restarts))


def substitute(faces: IntArray, target: IntArray, active: int) -> int:
    """Walk the chain of every corner to an active vertex, in place; return the vertices visited."""
    corners, hops = faces.reshape(-1), 0
    # Active vertices are a prefix, so one comparison tells them.  All corners hop together, and
    # those that have arrived drop out.
    moving = np.flatnonzero(corners >= active)
    while len(moving):
        hops += len(moving)
        corners[moving] = target[corners[moving]]
        moving = moving[corners[moving] >= active]
    return hops


def _active(step: IntArray, steps: int) -> IntArray:
    """Return how many are left after 0 to `steps` steps."""
    return len(step) - np.concatenate(([0], np.cumsum(np.bincount(step, minlength=steps)[:steps])))


def overhead_from(
    restart: Restart, target: IntArray, vertices_after: IntArray, faces_after: IntArray
) -> FloatArray:
    """Return the overhead after each step from a restart list on, (S + 1 - step,).

    Vertices visited over corners drawn, besides the one that is drawn: k of a chain of k links.

    A corner's chain is walked link by link; a link counts from the step that removes its vertex
    until the triangle is removed itself.
    """
    steps = len(faces_after) - 1
    # Row i goes in the first step after which no more than i rows are left.
    removed_face = np.searchsorted(-faces_after, -np.arange(len(restart.faces)), side="left")
    removed_vertex = np.searchsorted(-vertices_after, -np.arange(len(target)), side="left")
    # Where links begin and end to count; one running sum then gives how many do at each step.
    change = np.zeros(steps + 2)
    corner = restart.faces.reshape(-1)
    until = np.repeat(removed_face, 3)
    while len(corner):
        start = removed_vertex[corner]
        alive = start < until
        corner, until, start = target[corner[alive]], until[alive], start[alive]
        change += np.bincount(start, minlength=steps + 2)[: steps + 2]
        change -= np.bincount(until, minlength=steps + 2)[: steps + 2]
    extra = np.cumsum(change)[restart.step : steps + 1]
    return extra / (3.0 * faces_after[restart.step :])
