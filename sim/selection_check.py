"""The check of every selection of a replay, which is short where nothing has changed."""

from typing import TYPE_CHECKING

from ..models.scene.scene import Scene
from ..models.scene.tree import Tree
from ..policies.selection import Selection, find_wrong_nodes, find_wrong_values
from ..policies.view import View
from .loader import find_not_resident

if TYPE_CHECKING:
    from ..models.scene.nodes import Nodes


class SelectionCheck:
    """Checks the selections of one replay, frame after frame.

    Attributes
    ----------
    repeats : bool
        Whether the last selection draws all candidates at the details of the one before it, which
        are the same candidates: then nothing of it has to be looked at again.
    """

    def __init__(self, scene: Scene, tree: Tree | None) -> None:
        self._scene, self._tree = scene, tree
        self._nodes: Nodes | None = None  # of the last selection, if that can be repeated
        self._detail = b""
        self.repeats = False

    def find_violation(self, selection: object, view: View) -> str | None:
        """Return why a selection breaks its contract, or None; nothing is ever repaired."""
        wrong = find_wrong_values(selection, self._scene)
        if wrong is not None:
            return wrong
        assert isinstance(selection, Selection)
        # By value: a policy may return the same array every frame with other numbers in it.
        detail = selection.detail.tobytes()
        plain = selection.ids is view.ids and selection.holder is None
        self.repeats = plain and view.nodes is self._nodes and detail == self._detail
        if self.repeats:
            return None
        self._nodes, self._detail = view.nodes if plain else None, detail
        wrong = find_wrong_nodes(selection, view.nodes, self._tree)
        return wrong or find_not_resident(selection, view)
