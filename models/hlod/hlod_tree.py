"""Hierarchical levels of detail of one mesh, as in the HLOD thesis, section 3.2.

Each level is the whole mesh simplified to its share of triangles, then cut into the cells of that
level.  So cells of one level are pieces of one surface and meet without gaps, which simplifying
each piece by itself, as the thesis does, cannot promise.
"""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray, IntArray, derive, freeze
from ...base.errors import require_between
from ...base.predictors import LEVEL_PREDICTORS
from ..meshes.geometry import Geometry
from ..meshes.level_mesh import level_counts, level_mesh
from ..meshes.mesh_error import ErrorMeter, Sampling
from ..meshes.surface_mesh import SurfaceMesh
from .coarse_mesh import simplify_whole
from .hlod_cells import CellTree, grow_cells

_TEXTURE_BYTES = LEVEL_PREDICTORS.index("texture_bytes")


@dataclass(frozen=True, slots=True)
class HlodOptions:
    """How a mesh is divided.

    Attributes
    ----------
    desired_triangles : int
        Triangles wanted in each node.
    level_factor : int
        Pieces of a node, and triangles of a level over those of the coarser one; 2 to 16.
    max_levels : int
        1 to 8; the finest level is the full mesh.
    """

    desired_triangles: int = 900  # the thesis' table 6.1
    level_factor: int = 4  # table 6.1
    max_levels: int = 8

    def __post_init__(self) -> None:
        require_between(self.desired_triangles, 1, np.inf, "desired triangles")
        require_between(self.level_factor, 2, 16, "level factor")
        require_between(self.max_levels, 1, 8, "HLOD levels")

    def targets(self, triangles: int) -> list[float]:
        """Return simplification factors of the levels, coarsest first; the last one is 1.

        ``triangles / desired``, divided by the level factor from level to level until it is
        below 1.
        """
        factor, factors = triangles / self.desired_triangles, list[float]()
        while factor >= 1.0 and len(factors) < self.max_levels - 1:
            factors.append(factor)
            factor /= self.level_factor
        return [*factors, 1.0]


@dataclass(frozen=True, slots=True)
class Hlod:
    """A tree of N nodes, parents first; children replace their parent.

    Attributes
    ----------
    meshes : N meshes
    parent : (N,) int32
    depth : (N,) int32
    counts : (N, P) float64
        In the order of `LEVEL_PREDICTORS`.
    error_m : (N,) float64
        That of the whole level, measured against the full mesh.
    surface_m2 : (N,) float64
        Area of each node's triangles.
    normal : (N, 3) float64
        Mean of their normals by area, of length 1, or 0 where they cancel (thesis, section 3.3).
    low_m, high_m : (N, 3) float64
        Bounding boxes.
    bytes : (N,) float64
        Derived: vertex and index buffers.
    """

    name: str
    meshes: Geometry = field(repr=False)
    parent: Annotated[IntArray, np.int32, "N"]
    depth: Annotated[IntArray, np.int32, "N"]
    counts: Annotated[FloatArray, np.float64, "N", len(LEVEL_PREDICTORS)]
    error_m: Annotated[FloatArray, np.float64, "N"]
    surface_m2: Annotated[FloatArray, np.float64, "N"]
    normal: Annotated[FloatArray, np.float64, "N", 3]
    low_m: Annotated[FloatArray, np.float64, "N", 3]
    high_m: Annotated[FloatArray, np.float64, "N", 3]
    bytes: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        freeze(self, "hlod", N=len(self.meshes))
        derive(self, bytes=np.array([float(mesh.byte_count) for mesh in self.meshes]))


def build_hlod(full: SurfaceMesh, options: HlodOptions, sampling: Sampling) -> Hlod:
    """Return the tree of a mesh.

    A cell in which nothing is left of a coarse level gets its piece of the next finer one.
    Textures are down-sampled by the simplification factor of their level and divided by area.
    """
    factors = options.targets(len(full.faces))
    cells, finest = grow_cells(full, options.level_factor, len(factors))
    pieces, errors = [finest], [0.0]
    meter = ErrorMeter(full.positions, full.faces, sampling)
    for depth in range(len(factors) - 2, -1, -1):
        coarse = simplify_whole(full, factors[depth])
        error = meter.error_m(coarse.positions, coarse.faces)
        pieces.insert(0, cells.divide(coarse, depth, pieces[0]))
        errors.insert(0, max(error, errors[0]))
    shares = [_texture_shares(full, level, f) for level, f in zip(pieces, factors, strict=True)]
    return _gather(full.name, cells, pieces, errors, shares)


def _texture_shares(
    full: SurfaceMesh, pieces: list[SurfaceMesh], factor: float
) -> NDArray[np.float64]:
    """Return bytes of texture of each node of a level."""
    areas = np.array([_areas(piece)[piece.textured[piece.part]].sum() for piece in pieces])
    whole = float(areas.sum())
    return areas / whole * full.texture_bytes / factor if whole > 0.0 else np.zeros(len(areas))


def _areas(mesh: SurfaceMesh) -> FloatArray:
    return np.linalg.norm(_directed_areas(mesh), axis=1)


def _directed_areas(mesh: SurfaceMesh) -> FloatArray:
    """Return the normal of each triangle, as long as its area, (F, 3)."""
    a, b, c = (mesh.positions[mesh.faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a) / 2.0


def _mean_normal(mesh: SurfaceMesh) -> FloatArray:
    total: FloatArray = _directed_areas(mesh).sum(axis=0)
    length = float(np.linalg.norm(total))
    # A closed piece faces nowhere: what is left of its sum is rounding.
    return total / length if length > 1e-9 * _areas(mesh).sum() else np.zeros(3)


def _gather(
    name: str,
    cells: CellTree,
    pieces: list[list[SurfaceMesh]],
    errors: list[float],
    texture_bytes: list[NDArray[np.float64]],
) -> Hlod:
    nodes = [piece for level in pieces for piece in level]
    sizes = [len(level) for level in pieces]
    starts = np.cumsum([0, *sizes])
    parents = [np.full(sizes[0], -1)]
    parents += [cells.parent[d] + starts[d - 1] for d in range(1, len(pieces))]
    meshes = tuple(level_mesh(piece) for piece in nodes)
    table = np.stack([level_counts(*pair) for pair in zip(nodes, meshes, strict=True)])
    table[:, _TEXTURE_BYTES] = np.concatenate(texture_bytes)
    return Hlod(
        name,
        meshes,
        np.concatenate(parents),
        np.repeat(np.arange(len(pieces)), sizes),
        table,
        np.repeat(errors, sizes),
        np.array([float(_areas(piece).sum()) for piece in nodes]),
        np.stack([_mean_normal(piece) for piece in nodes]),
        np.stack([piece.positions.min(axis=0) for piece in nodes]),
        np.stack([piece.positions.max(axis=0) for piece in nodes]),
    )
