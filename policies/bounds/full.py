"""``full``: every object at its finest level."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...models.scene.scene import Scene
from ..protocol import Capabilities, Claims
from ..selection import Selection
from ..view import View


@dataclass(slots=True)
class Full:
    """Idea: no management; the baseline that every policy has to beat.

    Uses: nothing.

    Parameters: none.

    Knob: none, as nothing is finer and anything coarser would be management.

    Cost per frame: none.

    Reference: the "no optimization" run of Funkhouser and Séquin, SIGGRAPH 1993.
    """

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    claims: ClassVar[Claims] = Claims(settles_frames=0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Nothing to prepare."""

    def select(self, view: View) -> Selection:
        """Return the finest level, or resolution 1, of every candidate."""
        levels = view.scene.types.levels
        if not levels.continuous.any():
            return Selection(view.ids, np.zeros(len(view.ids)))
        return Selection(view.ids, levels.continuous[view.type_index].astype(np.float64))
