"""Half-edge collapses of a triangle mesh in the order of their quadric error."""

from dataclasses import dataclass
from heapq import heapify, heappop, heappush
from typing import Annotated, TypeAlias

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, freeze
from .quadrics import point_monomials, surface_quadrics

_Candidate: TypeAlias = tuple[float, int, int, int, int]

_MAX_FACES_REMOVED = 3
_LEAST_COSINE = 0.2  # of the angle by which a collapse may turn a triangle
_LEAST_HEIGHT = 1e-9  # of a triangle over its length; below, its normal is rounding


@dataclass(frozen=True, slots=True)
class Contraction:
    """S steps that contract a mesh of V vertices and F triangles.

    Attributes
    ----------
    steps : int
    vertex_step : (V,) int32
        Step in which each vertex is substituted; S if it never is.
    target : (V,) int32
        The vertex that takes its place; itself if none does.
    face_step : (F,) int32
        Step that removes each triangle; S if none does.
    """

    steps: int
    vertex_step: Annotated[IntArray, np.int32, "V"]
    target: Annotated[IntArray, np.int32, "V"]
    face_step: Annotated[IntArray, np.int32, "F"]

    def __post_init__(self) -> None:
        freeze(self, "contraction", V=len(self.vertex_step), F=len(self.face_step))


def contract(
    poses: FloatArray,
    faces: IntArray,
    *,
    drawn: IntArray | None = None,
    fixed: BoolArray | None = None,
) -> Contraction:
    """Collapse edges, cheapest first, as long as the mesh stays a mesh of the same kind.

    A collapse moves all triangles of one vertex to a neighbour, and no vertex is ever moved or
    made.  It must keep the topology (link condition), turn no triangle over in any pose, keep
    borders and non-manifold edges as curves, and remove at most three triangles.

    Parameters
    ----------
    poses : (P, V, 3)
        Positions in each pose; costs are averaged over the poses.
    faces : (F, 3)
        Positions of the corners.
    drawn : (F, 3), optional
        Drawn vertices of the corners, where several stand at one position (texture seams); they
        are substituted together, each along an edge of its own triangles.  Else the positions.
    fixed : (V,), optional
        Positions that never move.
    """
    # To unit size about the origin: quadrics hold squares of coordinates, whose digits a mesh far
    # from the origin would lose, and thresholds need no unit.
    low = poses.min(axis=(0, 1))
    size = float(np.ptp(poses, axis=1).max()) or 1.0
    surface = _Surface((poses - low) / size, faces, faces if drawn is None else drawn, fixed)
    surface.contract()
    return surface.record()


class _Surface:
    """The mesh while it is contracted, as sets and lists: single elements of arrays are slow."""

    def __init__(
        self, poses: FloatArray, faces: IntArray, drawn: IntArray, fixed: BoolArray | None
    ) -> None:
        self._poses = poses
        self._corners: list[list[int]] = faces.tolist()
        self._drawn: list[list[int]] = drawn.tolist()
        self._fixed = set[int]() if fixed is None else set[int](np.flatnonzero(fixed).tolist())
        self._faces_at: list[set[int]] = [set() for _ in range(poses.shape[1])]
        for row, corners in enumerate(self._corners):
            for vertex in corners:
                self._faces_at[vertex].add(row)
        self._quadric = surface_quadrics(poses, faces)
        self._monomials = point_monomials(poses)
        self._age = [0] * poses.shape[1]
        self._queue: list[_Candidate] = []
        self._waiting: dict[int, list[_Candidate]] = {}
        count = int(drawn.max()) + 1
        self._step = 0
        self._vertex_step = [-1] * count
        self._target = list(range(count))
        self._face_step = [-1] * len(faces)

    def contract(self) -> None:
        """Collapse until no collapse is allowed."""
        edges = [
            (v, u)
            for v, rows in enumerate(self._faces_at)
            if rows
            for u in self._around(v)
            if v not in self._fixed
        ]
        self._offer(edges)
        heapify(self._queue)
        while self._queue:
            candidate = heappop(self._queue)
            _, v, u, age_v, age_u = candidate
            # A heap cannot change a key: an entry whose vertices have changed since is passed over,
            # as a fresh one was queued when they changed.
            if self._age[v] != age_v or self._age[u] != age_u:
                continue
            plan = self._plan(v, u)
            if plan is None:
                # Perhaps allowed once a neighbour has collapsed: `_collapse` queues it again.
                self._waiting.setdefault(v, []).append(candidate)
            else:
                self._collapse(v, u, plan)

    def record(self) -> Contraction:
        """Return the steps so far."""
        vertex_step, face_step = np.array(self._vertex_step), np.array(self._face_step)
        vertex_step[vertex_step < 0] = self._step
        face_step[face_step < 0] = self._step
        return Contraction(self._step, vertex_step, np.array(self._target), face_step)

    def _around(self, v: int) -> dict[int, int]:
        """Return the neighbours of a vertex, and how many triangles are on the edge to each."""
        count: dict[int, int] = {}
        for row in self._faces_at[v]:
            for other in self._corners[row]:
                if other != v:
                    count[other] = count.get(other, 0) + 1
        return count

    def _offer(self, edges: list[tuple[int, int]]) -> None:
        """Queue the collapse of the first vertex of each edge into the second."""
        if not edges:
            return
        pairs = np.array(edges)
        v, u = pairs[:, 0], pairs[:, 1]
        # Garland and Heckbert's error of both vertices, at the place of the one that stays.
        costs = np.einsum("ij,ij->i", self._quadric[v] + self._quadric[u], self._monomials[u])
        for cost, (a, b) in zip(costs.tolist(), edges, strict=True):
            heappush(self._queue, (cost, a, b, self._age[a], self._age[b]))

    def _plan(self, v: int, u: int) -> dict[int, int] | None:
        """Return which drawn vertex takes the place of which, or None if v may not move to u."""
        removed = self._faces_at[v] & self._faces_at[u]
        if not 0 < len(removed) <= _MAX_FACES_REMOVED:
            return None
        around = self._around(v)
        # On a border or a non-manifold edge v may only follow that curve: it must have exactly two
        # such edges, and u must lie at the end of one.
        irregular = [other for other, count in around.items() if count != 2]
        if irregular and (len(irregular) != 2 or u not in irregular):
            return None
        # Link condition: the tips of the triangles that go are the only common neighbours.  The
        # two edges to any other would become one, and the surface would be pinched there.
        opposite = {x for row in removed for x in self._corners[row]} - {v, u}
        if (around.keys() & self._around(u).keys()) != opposite:
            return None
        moved = self._faces_at[v] - removed
        # A triangle of v on two of the tips would become (u, tip, tip), which may be there already.
        if any(opposite.issuperset(set(self._corners[row]) - {v}) for row in moved):
            return None
        # Each corner that stays keeps a triangle, so that no piece of the mesh vanishes.
        if not all(self._faces_at[x] - removed for x in (u, *opposite)):
            return None
        # Every drawn vertex at v needs one at u on its own side of a seam.
        plan = self._substitutes(v, u, removed)
        if plan is None or any(self._drawn_at(row, v) not in plan for row in moved):
            return None
        return None if moved and self._turns(v, u, moved) else plan

    def _drawn_at(self, row: int, v: int) -> int:
        return self._drawn[row][self._corners[row].index(v)]

    def _substitutes(self, v: int, u: int, removed: set[int]) -> dict[int, int] | None:
        plan: dict[int, int] = {}
        for row in removed:
            source, target = self._drawn_at(row, v), self._drawn_at(row, u)
            if plan.setdefault(source, target) != target:
                return None
        return plan

    def _turns(self, v: int, u: int, moved: set[int]) -> bool:
        """Whether a triangle turns by much, or loses its area, in any pose."""
        ends: list[list[int]] = []
        for row in moved:
            corners = self._corners[row]
            at = corners.index(v)
            # The corner after v, then the one before it: the triangle keeps its sense of rotation.
            ends.append([corners[at - 2], corners[at - 1]])
        b, c = np.array(ends).T
        x = self._poses
        edge = x[:, c] - x[:, b]
        before = _cross(edge, x[:, [v]] - x[:, b])
        after = _cross(edge, x[:, [u]] - x[:, b])
        dot = np.einsum("pij,pij->pi", before, after)
        size = np.einsum("pij,pij->pi", after, after)
        length = np.einsum("pij,pij->pi", before, before) * size
        side = x[:, [u]] - x[:, b]
        longest = np.maximum((edge * edge).sum(axis=2), (side * side).sum(axis=2))
        # `size` is the square of twice the area, and `longest` a squared length: the ratio of their
        # roots is height over length.
        thin = size <= (_LEAST_HEIGHT * longest) ** 2
        return bool((thin | (dot <= _LEAST_COSINE * np.sqrt(length))).any())

    def _collapse(self, v: int, u: int, plan: dict[int, int]) -> None:
        step = self._step
        self._step += 1
        for source, target in plan.items():
            self._vertex_step[source] = step
            self._target[source] = target
        for row in self._faces_at[v]:
            corners = self._corners[row]
            if u in corners:
                self._face_step[row] = step
                for other in corners:
                    if other != v:
                        self._faces_at[other].remove(row)
            else:
                at = corners.index(v)
                corners[at] = u
                self._drawn[row][at] = plan[self._drawn[row][at]]
                self._faces_at[u].add(row)
        self._faces_at[v] = set()
        # No entry was ever queued at this age, so v never moves again.
        self._age[v] = -1
        self._age[u] += 1
        # u answers for the planes of all that it stands for, so errors add up from the full mesh.
        self._quadric[u] += self._quadric[v]
        # Only edges at u have another cost now, and only v's neighbours other triangles.
        ring = list(self._around(u))
        edges = [(w, u) for w in ring if w not in self._fixed]
        if u not in self._fixed:
            edges += [(u, w) for w in ring]
        self._offer(edges)
        for w in ring:
            for candidate in self._waiting.pop(w, ()):
                heappush(self._queue, candidate)


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return cross products of the last axis; numpy's own is slow on few rows."""
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    p, q, r = b[..., 0], b[..., 1], b[..., 2]
    return np.stack((y * r - z * q, z * p - x * r, x * q - y * p), axis=-1)
