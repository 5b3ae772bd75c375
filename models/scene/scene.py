"""A scene: object types with levels of detail, and the nodes that place them.

Everything drawable is a node.  An object is a node without children; a tile or a group of trees is
a node of a tree.  Conventions: right-handed, z up, metres, quaternions ``x y z w``.
"""

from copy import copy
from dataclasses import dataclass, field
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...base.arrays import BoolArray, FloatArray, IntArray, derive, freeze, require_finite
from ...base.errors import InputError
from ..machine.cost import DISC_SHARE, CostModel
from .cells import Cells
from .levels import LevelTable
from .motion import Motion
from .rotation import rotate
from .sphere_blocks import SphereBlocks


@dataclass(frozen=True, slots=True)
class ObjectTypes:
    """K object types.

    Attributes
    ----------
    names : tuple of K strings
    center_m : (K, 3) float64
        Centre of the bounding sphere in the type's own frame.
    radius_m : (K,) float64
        Radius of the bounding sphere before scale; positive.
    levels : LevelTable
    disc_share : (K,) float64
        Share of the bounding sphere's disc that the type covers, in (0, 1]; `DISC_SHARE` where it
        was not measured.
    surface_m2 : (K,) float64
        Area of the triangles of the finest level, before scale; 0 where it was not measured.
    normal : (K, 3) float64
        Mean of the triangles' normals by area, of length 1; 0 where they cancel or were not
        measured.
    """

    names: tuple[str, ...]
    center_m: Annotated[FloatArray, np.float64, "K", 3]
    radius_m: Annotated[FloatArray, np.float64, "K"]
    levels: LevelTable
    disc_share: Annotated[FloatArray, np.float64, "K"] = field(default_factory=lambda: np.zeros(0))
    surface_m2: Annotated[FloatArray, np.float64, "K"] = field(default_factory=lambda: np.zeros(0))
    normal: Annotated[FloatArray, np.float64, "K", 3] = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        k = len(self.names)
        unmeasured = {
            "disc_share": np.full(k, DISC_SHARE),
            "surface_m2": np.zeros(k),
            "normal": np.zeros((k, 3)),
        }
        for name, values in unmeasured.items():
            if len(getattr(self, name)) == 0:
                derive(self, **{name: values})
        freeze(self, "type", K=k)
        require_finite(self.radius_m, "type radius_m", low=np.finfo(float).tiny)
        require_finite(self.surface_m2, "type surface_m2", low=0.0)
        require_finite(self.normal, "type normal")
        if not ((self.disc_share > 0.0) & (self.disc_share <= 1.0)).all():
            raise InputError("type disc_share: expected shares above 0 to 1, got others")
        if len(self.levels.start) != k + 1:
            got = len(self.levels.start) - 1
            raise InputError(f"levels: expected {k} types as in names, got {got}")


@dataclass(frozen=True, slots=True, repr=False)
class Scene:
    """N nodes over K types.

    Attributes
    ----------
    type_index : (N,) int32
    position_m : (N, 3) float64
    orientation_xyzw : (N, 4) float64, unit
    scale : (N,) float64, positive
    importance : (N,) float64, not negative
    parent : (N,) int32
        Parent node, or -1 for a root; parents stand before their children.
    additive : (N,) bool
        Whether a node stays drawn when its children are (3D Tiles' ADD) or is replaced by them.
    motion : Motion, optional
    cells : Cells, optional
        Rooms whose walls hide nodes; the simulator culls by them.
    costs : CostModel, optional
        The cost model that predictive policies may consult; bound by the replay.
    center_m, radius_m : (N, 3), (N,) float64
        Derived: bounding spheres in the scene frame, at rest.
    """

    name: str
    types: ObjectTypes
    type_index: Annotated[IntArray, np.int32, "N"]
    position_m: Annotated[FloatArray, np.float64, "N", 3]
    orientation_xyzw: Annotated[FloatArray, np.float64, "N", 4]
    scale: Annotated[FloatArray, np.float64, "N"]
    importance: Annotated[FloatArray, np.float64, "N"]
    parent: Annotated[IntArray, np.int32, "N"]
    additive: Annotated[BoolArray, np.bool_, "N"]
    motion: Motion | None = None
    cells: Cells | None = None
    costs: CostModel | None = None
    center_m: FloatArray = field(init=False)
    radius_m: FloatArray = field(init=False)
    roots: IntArray = field(init=False)
    child_start: IntArray = field(init=False)
    child_ids: IntArray = field(init=False)
    _by_node: dict[str, NDArray[Any]] = field(
        init=False, repr=False, compare=False, default_factory=dict[str, NDArray[Any]]
    )
    _blocks: list[SphereBlocks] = field(
        init=False, repr=False, compare=False, default_factory=list[SphereBlocks]
    )

    @classmethod
    def of(
        cls,
        name: str,
        types: ObjectTypes,
        type_index: IntArray,
        position_m: FloatArray,
        *,
        turn_xyzw: ArrayLike = (0.0, 0.0, 0.0, 1.0),
        scale: ArrayLike = 1.0,
        importance: ArrayLike = 1.0,
        parent: ArrayLike = -1,
        additive: ArrayLike = False,
        motion: Motion | None = None,
        cells: Cells | None = None,
    ) -> "Scene":
        """Return a scene; one value stands for all nodes, which are upright roots if none is given.

        Raises `InputError` as the scene itself does.
        """
        n = len(type_index)
        return cls(
            name,
            types,
            type_index,
            position_m,
            np.broadcast_to(turn_xyzw, (n, 4)),
            *(np.broadcast_to(given, n) for given in (scale, importance, parent, additive)),
            motion=motion,
            cells=cells,
        )

    def __post_init__(self) -> None:
        n = len(self.type_index)
        freeze(self, "node", N=n)
        self._check_nodes(n)
        turned = rotate(self.orientation_xyzw, self.types.center_m[self.type_index])
        roots = np.flatnonzero(self.parent < 0).astype(np.int32)
        counts = np.bincount(self.parent[self.parent >= 0], minlength=n)
        derive(
            self,
            center_m=self.position_m + self.scale[:, None] * turned,
            radius_m=self.scale * self.types.radius_m[self.type_index],
            roots=roots,
            child_start=np.concatenate(([0], np.cumsum(counts))).astype(np.int32),
            child_ids=np.argsort(self.parent, kind="stable")[len(roots) :].astype(np.int32),
        )

    def _check_nodes(self, n: int) -> None:
        if n == 0:
            raise InputError("scene: expected at least one node, got none")
        kinds = len(self.types.names)
        if self.type_index.min() < 0 or self.type_index.max() >= kinds:
            raise InputError(f"node type_index: expected 0 to {kinds - 1}, got values outside")
        require_finite(self.scale, "node scale", low=np.finfo(float).tiny)
        require_finite(self.importance, "node importance", low=0.0)
        norm = np.linalg.norm(self.orientation_xyzw, axis=1)
        if (np.abs(norm - 1.0) > 1e-6).any():
            raise InputError("node orientation_xyzw: expected unit quaternions")
        if (self.parent < -1).any() or (self.parent >= np.arange(n)).any():
            raise InputError("node parent: expected -1 or an earlier node")
        if self.cells is not None and len(self.cells.node_cell) != n:
            got = len(self.cells.node_cell)
            raise InputError(f"cells: expected a cell for each of {n} nodes, got {got}")
        if self.motion is not None and not np.isin(self.motion.node, np.arange(n)).all():
            raise InputError(f"motion node: expected 0 to {n - 1}, got values outside")

    def __len__(self) -> int:
        """Return the number of nodes."""
        return len(self.type_index)

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {len(self):,} nodes, {len(self.types.names):,} types>"

    @property
    def flat(self) -> bool:
        """Whether no node has a parent."""
        return len(self.roots) == len(self.type_index)

    @property
    def continuous(self) -> BoolArray:
        """Whether each node takes a resolution instead of a level index, (N,) bool."""
        return self.types.levels.continuous[self.type_index]

    @property
    def level_count(self) -> IntArray:
        """Levels of each node, (N,) int32."""
        return self.types.levels.level_count[self.type_index]

    @property
    def finest_row(self) -> NDArray[np.intp]:
        """Row of the level table of each node's finest level, (N,); gathered once."""
        if "finest_row" not in self._by_node:
            row = self.types.levels.start[self.type_index].astype(np.intp)
            row.flags.writeable = False
            self._by_node["finest_row"] = row
        return self._by_node["finest_row"]

    @property
    def coarsest_level(self) -> FloatArray:
        """Index of each node's coarsest level, or knot, (N,); gathered once."""
        if "coarsest_level" not in self._by_node:
            level = (self.level_count - 1).astype(np.float64)
            level.flags.writeable = False
            self._by_node["coarsest_level"] = level
        return self._by_node["coarsest_level"]

    @property
    def blocks(self) -> SphereBlocks:
        """The nodes that never move, in blocks of neighbours; put together once."""
        if not self._blocks:
            rests = np.ones(len(self), dtype=np.bool_)
            if self.motion is not None:
                rests[self.motion.node] = False
            self._blocks.append(SphereBlocks(self.center_m, self.radius_m, rests.nonzero()[0]))
        return self._blocks[0]

    def children(self, node: int) -> IntArray:
        """Return the children of a node in ascending order, int32."""
        return self.child_ids[self.child_start[node] : self.child_start[node + 1]]

    def with_costs(self, costs: CostModel) -> "Scene":
        """Return the same scene with a cost model that predictive policies may consult."""
        scene = copy(self)  # shares all arrays, unlike `replace`, which would check them again
        derive(scene, costs=costs)
        return scene
