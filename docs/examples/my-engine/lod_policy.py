"""The engine's choice of levels of detail, as lodbench drives it."""

from typing import ClassVar

import numpy as np

from lodbench.models.machine.frame_cost import FrameCost
from lodbench.models.scene.scene import Scene
from lodbench.policies import Capabilities, Selection, View, Work
from lodbench.policies.protocol import Claims


class FinestThatFits:
    """Draws everything at the finest common level that the cost model puts within the budget."""

    capabilities: ClassVar = Capabilities()
    claims: ClassVar = Claims(budget=True, settles_frames=0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Aim at 90 % of the budget, since measured times scatter."""
        assert scene.costs is not None, "a replay binds its cost model to the scene"
        self.costs = FrameCost(scene.costs, scene.types.levels)
        self.target_ms = 0.9 * budget_ms

    def select(self, view: View) -> Selection:
        """Go down level by level until the frame fits."""
        levels, kind = view.scene.types.levels, view.type_index
        detail, ms = np.zeros(len(view)), 0.0
        for level in range(levels.level_count.max()):
            detail = np.minimum(level, levels.level_count[kind] - 1.0)
            row = levels.start[kind] + detail.astype(np.int32)
            ms = self.costs.frame(row, view, view.viewport_px).gpu_ms
            if ms <= self.target_ms:
                break
        return Selection(view.ids, detail, Work(objects_visited=len(view)), predicted_ms=ms)
