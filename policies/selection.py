"""What a policy decides for one frame, and the check that the simulator makes of it."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..base.arrays import FloatArray, IntArray
from ..base.foreign_text import describe_value, type_name
from ..base.predictors import POLICY_WORK
from ..models.scene.nodes import Nodes
from ..models.scene.scene import Scene
from ..models.scene.tree import Tree

MOST_WORK = 10**12
"""What a count of `Work` is at most: a million objects, each a million times."""

MOST_PREDICTED_MS = 1e9
"""What a prediction is at most: eleven days for one frame."""

LEAST_RENDER_SCALE = 1.0 / 1024.0
"""What a render scale is at least: a picture a few pixels wide on any display."""

_NUMPY_REALS = (np.float64, np.float32, *(np.dtype(code).type for code in "bhilqBHILQ"))
_ROUNDING = 1e-9  # by which a resolution may miss that of the coarsest level


@dataclass(frozen=True, slots=True)
class Work:
    """Counts that the CPU cost model turns into milliseconds.

    Each is a number from 0 to `MOST_WORK`: an int, a float, or an integer, float32 or float64 of
    numpy; no truth value, no subclass of these.

    Attributes
    ----------
    objects_visited : int
        Objects whose detail the policy considered.
    comparisons : int
        Comparisons of sorting and searching.
    iterations : int
        Passes of an iterative solver.
    """

    objects_visited: int = 0
    comparisons: int = 0
    iterations: int = 0


@dataclass(frozen=True, slots=True)
class Selection:
    """Nodes drawn in a frame; arrays are numpy's own, of no subclass.

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
        GPU time that a predictive policy expects, 0 to `MOST_PREDICTED_MS`; NaN if it predicts
        none.
    wanted : (w,) int32, optional
        Nodes that the loader is to have in memory, by falling priority; None keeps the last list.
    render_scale : float
        Width of the picture rendered over the window's, `LEAST_RENDER_SCALE` to 1; the display
        scales it up.  Its square multiplies pixels, and with them benefit, whose size is counted in
        pixels.
    """

    ids: IntArray
    detail: FloatArray
    work: Work = field(default_factory=Work)
    holder: IntArray | None = None
    predicted_ms: float = float("nan")
    wanted: IntArray | None = None
    render_scale: float = 1.0


def find_violation(
    selection: object, candidates: IntArray, scene: Scene, tree: Tree | None = None
) -> str | None:
    """Return why a selection breaks its contract, or None; nothing is ever repaired."""
    wrong = find_wrong_values(selection, scene)
    if wrong is not None:
        return wrong
    assert isinstance(selection, Selection)
    return find_wrong_nodes(selection, Nodes(scene, candidates), tree)


def find_wrong_values(selection: object, scene: Scene) -> str | None:
    """Return what of a selection is no array or number of its kind, whatever the view, or None."""
    if type(selection) is not Selection:
        return f"expected a Selection, got {type_name(selection)}"
    ids, holder = selection.ids, selection.holder
    return (
        _wrong_array("ids", ids, "i", None)
        or _wrong_array("detail", selection.detail, "f", len(ids))
        or (None if holder is None else _wrong_array("holder", holder, "i", len(ids)))
        or find_wrong_numbers(selection)
        or (None if selection.wanted is None else _wrong_wanted(selection.wanted, scene))
    )


def find_wrong_numbers(selection: Selection) -> str | None:
    """Return which number of a selection has a value that it must not have, or None."""
    return _wrong_numbers(selection.work, selection.predicted_ms, selection.render_scale)


def find_wrong_nodes(
    selection: Selection, candidates: Nodes, tree: Tree | None = None
) -> str | None:
    """Return which node or detail a selection of well-formed arrays must not have, or None.

    The common case, one detail for every candidate in the view's own order, is the cheapest.
    """
    scene, ids, holder = candidates.scene, selection.ids, selection.holder
    if len(ids) == 0:
        return None
    whole = ids is candidates.ids
    wrong = None if whole else _wrong_ids(ids, candidates.ids, scene)
    if wrong is None:
        nodes = candidates if whole else Nodes(scene, ids)
        wrong = _wrong_detail(nodes, selection.detail)
    if wrong is None and holder is not None:
        wrong = _wrong_holder(ids, holder, scene)
    if wrong is None and tree is not None and (twice := tree.drawn_twice(ids)) >= 0:
        return f"ids: expected a front, got node {twice} below another that replaces it"
    return wrong


def _wrong_array(name: str, array: Any, kind: str, length: int | None) -> str | None:
    # A masked array, or another subclass, may compare and index as it likes.
    if type(array) is not np.ndarray or array.ndim != 1:
        return f"{name}: expected a one-dimensional numpy array, got {type_name(array)}"
    if array.dtype.kind != kind or (kind == "f" and array.dtype.itemsize != 8):
        expected = "integers" if kind == "i" else "float64"
        return f"{name}: expected {expected}, got {describe_value(array.dtype)}"
    if length is not None and array.size != length:
        return f"{name}: expected {length} values as in ids, got {array.size}"
    return None


def _wrong_range(name: str, ids: IntArray, scene: Scene) -> str | None:
    low, high = int(ids.min()), int(ids.max())
    if low < 0 or high >= len(scene):
        return f"{name}: expected 0 to {len(scene) - 1}, got {low} to {high}"
    return None


def _is_real(value: object) -> bool:
    """Whether a value is a number that compares as numbers do, which no user's class need do.

    Of numpy's numbers those that are complex, of half or of extended precision are not: products
    with them are, too.
    """
    kind = type(value)
    return kind is int or kind is float or any(kind is known for known in _NUMPY_REALS)


def _wrong_numbers(work: Any, predicted_ms: Any, render_scale: Any) -> str | None:
    if type(work) is not Work:
        return f"work: expected a Work, got {type_name(work)}"
    for name in POLICY_WORK:
        count: Any = getattr(work, name, None)
        if not _is_real(count) or not 0 <= count <= MOST_WORK:
            got = describe_value(count)
            return f"work: expected {name} from 0 to {MOST_WORK:g}, got {got}"
    if not _is_real(predicted_ms) or predicted_ms < 0 or predicted_ms > MOST_PREDICTED_MS:
        expected = f"milliseconds from 0 to {MOST_PREDICTED_MS:g} or NaN"
        return f"predicted_ms: expected {expected}, got {describe_value(predicted_ms)}"
    if not _is_real(render_scale) or not LEAST_RENDER_SCALE <= render_scale <= 1:
        expected = f"a number from {LEAST_RENDER_SCALE:.4f} to 1"
        return f"render_scale: expected {expected}, got {describe_value(render_scale)}"
    return None


def _wrong_ids(ids: IntArray, candidates: IntArray, scene: Scene) -> str | None:
    if len(ids) > len(scene):
        return f"ids: expected distinct nodes, got {len(ids)} of {len(scene)}"
    if wrong := _wrong_range("ids", ids, scene):
        return wrong
    seen = np.zeros(len(scene), dtype=np.bool_)
    seen[ids] = True
    if int(seen.sum()) != len(ids):
        return "ids: expected distinct nodes, got a node twice"
    if scene.flat:
        seen[candidates] = False
        if seen.any():
            return f"ids: expected candidates of the view, got node {int(seen.argmax())}"
    return None


def _wrong_holder(ids: IntArray, holder: IntArray, scene: Scene) -> str | None:
    if wrong := _wrong_range("holder", holder, scene):
        return wrong
    other = scene.type_index[holder] != scene.type_index[ids]
    if other.any():
        at = int(other.argmax())
        return f"holder of node {ids[at]}: expected its type, got node {holder[at]} of another type"
    return None


def _wrong_wanted(wanted: IntArray, scene: Scene) -> str | None:
    wrong = _wrong_array("wanted", wanted, "i", None)
    if wrong or len(wanted) == 0:
        return wrong
    if len(wanted) > len(scene):
        return f"wanted: expected distinct nodes, got {len(wanted)} of {len(scene)}"
    if wrong := _wrong_range("wanted", wanted, scene):
        return wrong
    if len(np.unique(wanted)) != len(wanted):
        return "wanted: expected distinct nodes, got a node twice"
    return None


def _wrong_detail(nodes: Nodes, detail: FloatArray) -> str | None:
    levels = nodes.scene.types.levels
    good = np.trunc(detail) == detail
    good &= detail >= 0.0
    good &= detail <= nodes.coarsest_level
    if levels.continuous.any():
        low = levels.min_resolution.take(nodes.type_at) - _ROUNDING
        soft = levels.continuous.take(nodes.type_at)
        good = np.where(soft, (detail >= low) & (detail <= 1.0), good)
    if np.count_nonzero(good) == len(good):
        return None
    at = int(np.argmin(good))
    kind_at = int(nodes.type_at[at])
    expected = (
        f"a resolution from {levels.min_resolution[kind_at]:g} to 1"
        if levels.continuous[kind_at]
        else f"a level from 0 to {int(levels.level_count[kind_at]) - 1}"
    )
    return f"detail of node {int(nodes.ids[at])}: expected {expected}, got {detail[at]:g}"
