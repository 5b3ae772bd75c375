"""Continuous types from ordered meshes: knots of resolution with measured errors."""

from dataclasses import dataclass, replace

import numpy as np

from ...base.arrays import FloatArray, IntArray
from ...base.errors import require_between
from ..meshes.attributes import carry_uv
from ..meshes.mesh_error import Sampling
from ..meshes.surface_mesh import SurfaceMesh
from ..meshes.type_model import TypeModel, measure_levels
from .collapse import contract
from .ordered_mesh import OrderedMesh, order_mesh
from .texture import DrawnVertices, contract_textured


@dataclass(frozen=True, slots=True)
class KnotOptions:
    """At which resolutions a continuous type is measured.

    Attributes
    ----------
    knots : int
        At most, geometrically spaced from the full mesh to the coarsest; 2 to 256.
    min_triangles : int
        No knot aims lower.
    keep_texture : bool
        Whether the collapse keeps texture seams (Peng), which leaves more triangles in the
        coarsest mesh; otherwise coordinates are carried over to the collapsed mesh.
    """

    knots: int = 12
    min_triangles: int = 32
    keep_texture: bool = False

    def __post_init__(self) -> None:
        require_between(self.knots, 2, 256, "knots")
        require_between(self.min_triangles, 1, np.inf, "min_triangles")


@dataclass(frozen=True, slots=True)
class OrderedSurface:
    """A surface in total order, with the material and texture of whatever is extracted.

    Attributes
    ----------
    ordered : OrderedMesh
    drawn : DrawnVertices, optional
        What the mesh is made of where texture is kept; otherwise vertices are positions.
    """

    full: SurfaceMesh
    ordered: OrderedMesh
    drawn: DrawnVertices | None

    @classmethod
    def of(
        cls, full: SurfaceMesh, *, keep_texture: bool = False, poses: FloatArray | None = None
    ) -> "OrderedSurface":
        """Collapse and order a surface, by its mean cost over `poses`, (P, V, 3), if it moves."""
        if keep_texture:
            drawn, contraction = contract_textured(full, poses)
            return cls(full, order_mesh(drawn.corner, contraction), drawn)
        contraction = contract(full.positions[None] if poses is None else poses, full.faces)
        return cls(full, order_mesh(full.faces, contraction), None)

    def extract(self, triangles: int) -> tuple[IntArray, IntArray, IntArray]:
        """Return positions, part and texture coordinates of the corners of T triangles.

        Shapes (T, 3), (T,), (T, 3), all rows of the full surface; T as `OrderedMesh.extract`.
        """
        rows = self.ordered.extract(triangles)
        vertex = self.ordered.vertex_source[rows]
        part = self.full.part[self.ordered.face_source[: len(rows)]]
        if self.drawn is not None:
            return self.drawn.position[vertex], part, self.drawn.uv_index[vertex]
        return vertex, part, carry_uv(self.full, self.full.positions, vertex, part)


def build_continuous(
    surface: OrderedSurface, options: KnotOptions, sampling: Sampling
) -> TypeModel:
    """Return the knots of an ordered surface, each extracted from it and measured against it."""
    levels = [surface.full]
    for count in _knot_counts(surface.ordered, options)[1:]:
        faces, part, uv_index = surface.extract(int(count))
        levels.append(replace(surface.full, faces=faces, part=part, uv_index=uv_index))
    return measure_levels(levels, sampling, continuous=True)


def _knot_counts(ordered: OrderedMesh, options: KnotOptions) -> IntArray:
    """Return distinct numbers of triangles that can be had, falling."""
    least, full = int(ordered.faces_after[-1]), int(ordered.faces_after[0])
    # `min_triangles` may lie below what the mesh collapses to, or above the full mesh.
    end = min(max(least, options.min_triangles), full)
    wanted: FloatArray = np.geomspace(full, end, options.knots)
    # A step removes up to three triangles, so that several counts may lead to one step.
    steps = [ordered.step_of(int(count)) for count in np.clip(np.round(wanted), least, full)]
    return ordered.faces_after[np.unique(steps)]
