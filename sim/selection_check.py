"""The check of every selection of a replay, which is short where nothing has changed."""

import numpy as np
from numpy.typing import NDArray

from ..base.arrays import FloatArray
from ..models.scene.scene import Scene
from ..models.scene.tree import Tree
from ..policies.selection import (
    Selection,
    find_wrong_nodes,
    find_wrong_numbers,
    find_wrong_values,
)
from ..policies.view import View
from .loader import find_not_resident


class SelectionCheck:
    """Checks the selections of one replay, frame after frame.

    Attributes
    ----------
    repeats : bool
        Whether the last selection draws all candidates at the details of the one before it, and
        the candidates are the same: then its nodes and details need no second look.
    changed : (c,) intp, or None
        Positions at which the last selection draws another detail than the node was last drawn at;
        None if that was not looked for.
    """

    def __init__(self, scene: Scene, tree: Tree | None) -> None:
        self._scene, self._tree = scene, tree
        # Of such scenes nothing is streamed, and any level of a candidate may be drawn.
        self._discrete = tree is None and not scene.types.levels.continuous.any()
        # Of the last selection, if it drew all candidates, each from its own index set.
        self._ids: object = None
        self._detail = b""
        self.repeats = False
        self.changed: NDArray[np.intp] | None = None

    def find_violation(self, selection: object, view: View) -> str | None:
        """Return why a selection breaks its contract, or None; nothing is ever repaired."""
        self.changed = None
        self.repeats = type(selection) is Selection and self._is_last(selection, view)
        if self.repeats:
            assert isinstance(selection, Selection)
            return find_wrong_numbers(selection)
        wrong = find_wrong_values(selection, self._scene)
        if wrong is not None:
            return wrong
        assert isinstance(selection, Selection)
        plain = selection.ids is view.ids and selection.holder is None
        self._ids = view.ids if plain else None
        self._detail = selection.detail.tobytes() if plain else b""
        if plain and self._discrete:
            self.changed = _find_changed(selection.detail, view)
            if _are_levels(selection.detail, self.changed, view):
                return None
        wrong = find_wrong_nodes(selection, view.nodes, self._tree)
        return wrong or find_not_resident(selection, view)

    def _is_last(self, selection: Selection, view: View) -> bool:
        if self._ids is not view.ids or selection.ids is not view.ids:
            return False
        if selection.holder is not None or selection.wanted is not None:
            return False
        detail: object = selection.detail
        # By value: a policy may return the same array every frame with other numbers in it.
        return (
            type(detail) is np.ndarray  # another class may say of its bytes what it likes
            and detail.dtype == np.float64
            and detail.ndim == 1
            and detail.tobytes() == self._detail
        )


def _find_changed(detail: FloatArray, view: View) -> NDArray[np.intp]:
    """Return the positions of candidates whose details are not those that they last had."""
    return (detail != view.previous_detail).nonzero()[0]


def _are_levels(detail: FloatArray, changed: NDArray[np.intp], view: View) -> bool:
    """Whether details are levels of the candidates; False says nothing, as -0.0 may be one too.

    What a node was last drawn at was a level of its type then, and so is one now.
    """
    if not len(changed):
        return True
    level = detail.take(changed)
    nearest = np.trunc(level)
    np.fmax(nearest, 0.0, out=nearest)  # `maximum` would hand NaN through, which is no level
    nodes = view.nodes.at.take(changed)
    np.minimum(nearest, view.scene.coarsest_level.take(nodes), out=nearest)
    return nearest.tobytes() == level.tobytes()
