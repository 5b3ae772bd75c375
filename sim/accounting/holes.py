"""What should be drawn and is not: levels without geometry, and objects that are left out.

Who selects a level without geometry draws nothing there.  What is missing errs by its whole size.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import BoolArray
from ...models.scene.content import level_content
from ...models.scene.scene import Scene
from ...policies.selection import Selection
from ...policies.view import View
from .switches import Drawn


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


def with_missing(drawn: Drawn, units: View, at: NDArray[np.intp]) -> Drawn:
    """Return what is drawn and, at some positions of `units`, what is missing, to judge errors by.

    A hole errs by the diameter of the node's bounding sphere.
    """
    ids = np.concatenate((drawn.ids, units.ids.take(at)))
    xyz_m = np.concatenate((drawn.seen.xyz_m, units.xyz_m.take(at, axis=1)), axis=1)
    size_m = 2.0 * units.scene.types.radius_m.take(units.type_index.take(at))
    none = np.zeros(len(at))
    return Drawn(
        ids,
        np.concatenate((drawn.detail, none)),
        np.concatenate((drawn.row, units.nodes.finest_row.take(at))),
        None if drawn.fraction is None else np.concatenate((drawn.fraction, none)),
        units.state.view(ids, xyz_m),
        np.concatenate((drawn.error_m, size_m)),
    )
