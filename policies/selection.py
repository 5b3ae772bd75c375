"""What a policy decides for one frame, and the check that the simulator makes of it."""

from dataclasses import dataclass, field

import numpy as np

from ..models.arrays import FloatArray, IntArray
from ..models.scene import Scene
from ..models.tree import Tree

__all__ = ["Selection", "Work", "find_violation"]


@dataclass(frozen=True, slots=True)
class Work:
    """Counts that the CPU cost model turns into milliseconds.

    Attributes
    ----------
    objects_visited : objects whose detail the policy considered
    comparisons : comparisons of sorting and searching
    iterations : passes of an iterative solver
    """

    objects_visited: int = 0
    comparisons: int = 0
    iterations: int = 0


@dataclass(frozen=True, slots=True)
class Selection:
    """Nodes drawn in a frame.

    Attributes
    ----------
    ids : (m,) int32
        Distinct nodes: candidates of a flat scene's view; in a tree nodes of which none stands
        below another that replaces it (those outside the frustum are culled, not drawn).
    detail : (m,) float64
        Level index (0 = finest) of discrete nodes, resolution in (0, 1] of continuous ones, 0 of
        hierarchy nodes with a single level.
    work : Work
    holder : (m,) int32, optional
        Node whose extracted level each node draws (LODManager's sharing); its own id if it
        extracts for itself.
    predicted_ms : float
        GPU time that a predictive policy expects; NaN if it predicts none.
    """

    ids: IntArray
    detail: FloatArray
    work: Work = field(default_factory=Work)
    holder: IntArray | None = None
    predicted_ms: float = float("nan")


def find_violation(
    selection: object, candidates: IntArray, scene: Scene, tree: Tree | None = None
) -> str | None:
    """Return why a selection breaks its contract, or None; nothing is ever repaired.

    The common case, one detail for every candidate in the view's own order, costs two reductions.
    """
    if not isinstance(selection, Selection):
        return f"expected a Selection, got {type(selection).__name__}"
    ids, detail = selection.ids, selection.detail
    for name, array, kind in (("ids", ids, "i"), ("detail", detail, "f")):
        if not isinstance(array, np.ndarray) or array.ndim != 1:  # pyright: ignore[reportUnnecessaryIsInstance] - a user's policy may return anything
            return f"{name}: expected a one-dimensional numpy array, got {type(array).__name__}"
        if array.dtype.kind != kind:
            expected = "integers" if kind == "i" else "floats"
            return f"{name}: expected {expected}, got {array.dtype}"
    if len(ids) != len(detail):
        return f"detail: expected {len(ids)} values as in ids, got {len(detail)}"
    if len(ids) == 0:
        return None
    wrong = _wrong_ids(ids, candidates, scene) or _wrong_detail(ids, detail, scene)
    if wrong is None and tree is not None and (twice := tree.drawn_twice(ids)) >= 0:
        return f"ids: expected a front, got node {twice} below another that replaces it"
    return wrong


def _wrong_ids(ids: IntArray, candidates: IntArray, scene: Scene) -> str | None:
    if ids is candidates:
        return None
    if int(ids.min()) < 0 or int(ids.max()) >= len(scene):
        return f"ids: expected 0 to {len(scene) - 1}, got {int(ids.min())} to {int(ids.max())}"
    seen = np.zeros(len(scene), dtype=np.bool_)
    seen[ids] = True
    if int(seen.sum()) != len(ids):
        return "ids: expected distinct nodes, got a node twice"
    if scene.flat:
        seen[candidates] = False
        if seen.any():
            return f"ids: expected candidates of the view, got node {int(seen.argmax())}"
    return None


def _wrong_detail(ids: IntArray, detail: FloatArray, scene: Scene) -> str | None:
    levels = scene.types.levels
    kind = scene.type_index[ids]
    if not levels.continuous.any():
        coarsest = levels.level_count[kind] - 1
        good = (detail >= 0) & (detail <= coarsest) & (np.trunc(detail) == detail)
    else:
        soft = levels.continuous[kind]
        low = np.where(soft, levels.min_resolution[kind] - 1e-9, 0.0)
        high = np.where(soft, 1.0, levels.level_count[kind] - 1)
        good = (detail >= low) & (detail <= high) & (soft | (np.trunc(detail) == detail))
    if good.all():
        return None
    at = int(np.argmin(good))
    kind_at = int(kind[at])
    expected = (
        f"a resolution from {levels.min_resolution[kind_at]:g} to 1"
        if levels.continuous[kind_at]
        else f"a level from 0 to {int(levels.level_count[kind_at]) - 1}"
    )
    return f"detail of node {int(ids[at])}: expected {expected}, got {detail[at]:g}"
