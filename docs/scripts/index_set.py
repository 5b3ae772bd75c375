"""The index set that draws an ordered mesh, changed in place from resolution to resolution."""

from dataclasses import dataclass

import numpy as np

from lodbench.base.arrays import IntArray
from lodbench.models.continuous.foliage import Foliage
from lodbench.models.continuous.ordered_mesh import OrderedMesh, substitute


@dataclass(frozen=True, slots=True)
class ExtractionWork:
    """Operations that changed an index set.

    Attributes
    ----------
    triangles_changed : int
        Triangles added, removed, or drawn with another corner than before.
    index_writes : int
        Indices written; triangles at the end are removed without one.
    vertices_visited : int
        Vertices compared with the active range: each corner drawn, and each link of its chain.
    """

    triangles_changed: int
    index_writes: int
    vertices_visited: int


class IndexSet:
    """Index buffer of one object of a continuous type, at full resolution when made.

    Coarsening walks on from the vertices drawn now; refining starts from the restart list, as
    chains lead only one way.
    """

    __slots__ = ("_faces", "_mesh", "_step")

    def __init__(self, mesh: OrderedMesh) -> None:
        self._mesh = mesh
        self._faces = mesh.restarts[0].faces.copy()
        self._step = 0

    @property
    def faces(self) -> IntArray:
        """The triangles drawn now, (T, 3), as a view that the next change overwrites."""
        return self._faces[: self._mesh.faces_after[self._step]]

    def change(self, triangles: int) -> ExtractionWork:
        """Bring the set to at most this many triangles; return the operations that it took.

        Raises `InputError` if the number is not between the coarsest and the full mesh's.
        """
        mesh, before = self._mesh, len(self.faces)
        step = mesh.step_of(triangles)
        after, active = int(mesh.faces_after[step]), int(mesh.vertices_after[step])
        # Substitutes lead to coarser vertices only: what is drawn now is a start for coarsening.
        source = self._faces if step >= self._step else mesh.restart_at(step).faces
        fresh = source[:after].copy()
        visited = fresh.size + substitute(fresh, mesh.target, active)
        # Triangles of both sets stand in the same rows; the others are new, or cut off at the end.
        kept = min(before, after)
        differs = fresh[:kept] != self._faces[:kept]
        self._faces[:after] = fresh
        self._step = step
        return ExtractionWork(
            abs(after - before) + int(differs.any(axis=1).sum()),
            int(np.count_nonzero(differs)) + 3 * (after - kept),
            visited,
        )


def change_leaves(foliage: Foliage, before: int, after: int) -> ExtractionWork:
    """Return what bringing an index set from one count of leaves to another takes.

    A leaf that comes writes six indices; one that goes frees their place for it.
    """
    old, new = foliage.extract(before), foliage.extract(after)
    come = len(np.setdiff1d(new, old, assume_unique=True))
    gone = len(np.setdiff1d(old, new, assume_unique=True))
    return ExtractionWork(2 * (come + gone), 6 * come, come + gone)
