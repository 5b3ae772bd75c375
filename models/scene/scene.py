"""A scene: object types with levels of detail, and the nodes that place them.

Everything drawable is a node.  An object is a node without children; a tile or a group of trees is
a node of a tree.  Conventions: right-handed, z up, metres, quaternions ``x y z w``.
"""

from copy import copy
from dataclasses import dataclass, field

import numpy as np

from ...base.arrays import BoolArray, FloatArray, IntArray, frozen_array, require_finite
from ...base.errors import InputError
from ..machine.cost import DISC_SHARE, CostModel
from .cells import Cells
from .levels import LevelTable
from .motion import Motion
from .rotation import rotate


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
    """

    names: tuple[str, ...]
    center_m: FloatArray
    radius_m: FloatArray
    levels: LevelTable
    disc_share: FloatArray = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        k = len(self.names)
        put = object.__setattr__
        put(self, "center_m", frozen_array(self.center_m, np.float64, (k, 3), "type center_m"))
        put(self, "radius_m", frozen_array(self.radius_m, np.float64, (k,), "type radius_m"))
        require_finite(self.center_m, "type center_m")
        require_finite(self.radius_m, "type radius_m", low=np.finfo(float).tiny)
        share = self.disc_share if len(self.disc_share) else np.full(k, DISC_SHARE)
        put(self, "disc_share", frozen_array(share, np.float64, (k,), "type disc_share"))
        if not ((self.disc_share > 0.0) & (self.disc_share <= 1.0)).all():
            raise InputError("type disc_share: expected shares above 0 to 1, got others")
        if len(self.levels.start) != k + 1:
            got = len(self.levels.start) - 1
            raise InputError(f"levels: expected {k} types as in names, got {got}")


@dataclass(frozen=True, slots=True)
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
    type_index: IntArray
    position_m: FloatArray
    orientation_xyzw: FloatArray
    scale: FloatArray
    importance: FloatArray
    parent: IntArray
    additive: BoolArray
    motion: Motion | None = None
    cells: Cells | None = None
    costs: CostModel | None = None
    center_m: FloatArray = field(init=False)
    radius_m: FloatArray = field(init=False)
    roots: IntArray = field(init=False)
    child_start: IntArray = field(init=False, repr=False)
    child_ids: IntArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        n = len(self.type_index)
        put = object.__setattr__
        for name, dtype, shape in (
            ("type_index", np.int32, (n,)),
            ("position_m", np.float64, (n, 3)),
            ("orientation_xyzw", np.float64, (n, 4)),
            ("scale", np.float64, (n,)),
            ("importance", np.float64, (n,)),
            ("parent", np.int32, (n,)),
            ("additive", np.bool_, (n,)),
        ):
            put(self, name, frozen_array(getattr(self, name), dtype, shape, f"node {name}"))
        self._check_nodes(n)
        turned = rotate(self.orientation_xyzw, self.types.center_m[self.type_index])
        center = self.position_m + self.scale[:, None] * turned
        radius = self.scale * self.types.radius_m[self.type_index]
        put(self, "center_m", frozen_array(center, np.float64, (n, 3), "center_m"))
        put(self, "radius_m", frozen_array(radius, np.float64, (n,), "radius_m"))
        roots = np.flatnonzero(self.parent < 0)
        put(self, "roots", frozen_array(roots, np.int32, (len(roots),), "roots"))
        counts = np.bincount(self.parent[self.parent >= 0], minlength=n)
        start = np.concatenate(([0], np.cumsum(counts)))
        order = np.argsort(self.parent, kind="stable")[len(roots) :]
        put(self, "child_start", frozen_array(start, np.int32, (n + 1,), "child_start"))
        put(self, "child_ids", frozen_array(order, np.int32, (n - len(roots),), "child_ids"))

    def _check_nodes(self, n: int) -> None:
        if n == 0:
            raise InputError("scene: expected at least one node, got none")
        kinds = len(self.types.names)
        if self.type_index.min() < 0 or self.type_index.max() >= kinds:
            raise InputError(f"node type_index: expected 0 to {kinds - 1}, got values outside")
        require_finite(self.position_m, "node position_m")
        require_finite(self.orientation_xyzw, "node orientation_xyzw")
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

    def children(self, node: int) -> IntArray:
        """Return the children of a node in ascending order, int32."""
        return self.child_ids[self.child_start[node] : self.child_start[node + 1]]

    def with_costs(self, costs: CostModel) -> "Scene":
        """Return the same scene with a cost model that predictive policies may consult."""
        scene = copy(self)  # shares all arrays, unlike `replace`, which would check them again
        object.__setattr__(scene, "costs", costs)
        return scene
