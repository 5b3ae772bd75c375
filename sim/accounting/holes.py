"""Levels without geometry: who selects one draws nothing there, and it is missing."""

from dataclasses import replace

from ...base.arrays import BoolArray
from ...models.scene.content import level_content
from ...models.scene.scene import Scene
from ...policies.selection import Selection


class Holes:
    """Which levels of a scene have nothing to draw.

    Attributes
    ----------
    any : bool
        Whether there are such levels: most scenes have none, and pay nothing for the question.
    """

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._content = level_content(scene.types.levels)
        self.any = bool((self._content == 0.0).any())

    def cut(self, selection: Selection) -> Selection:
        """Return what of a selection is drawn."""
        ids = selection.ids
        at = self._scene.types.levels.position(self._scene.type_index[ids], selection.detail)
        keep = self._scene.types.levels.interpolate(self._content, *at) > 0.0
        if keep.all():
            return selection
        return only(selection, keep)


def only(selection: Selection, keep: BoolArray) -> Selection:
    """Return a selection of some of its nodes, (m,) bool."""
    holder = None if selection.holder is None else selection.holder[keep]
    return replace(selection, ids=selection.ids[keep], detail=selection.detail[keep], holder=holder)
