"""The engine's choice of levels of detail, as lodbench drives it."""

from typing import ClassVar

import numpy as np

from lodbench.base.predictors import FRAMEBUFFER_PIXELS, STATE_CHANGES
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
        self.costs, self.levels, self.target_ms = scene.costs, scene.types.levels, 0.9 * budget_ms

    def select(self, view: View) -> Selection:
        """Go down level by level until the frame fits."""
        costs, levels, kind = self.costs, self.levels, view.type_index
        fixed_ms = costs.base_ms + view.camera.viewport_px * costs.linear_ms[FRAMEBUFFER_PIXELS]
        fixed_ms += len(np.unique(kind)) * costs.linear_ms[STATE_CHANGES]
        linear, geometry = costs.level_ms(levels)
        detail, ms = np.zeros(len(view)), 0.0
        for level in range(levels.level_count.max()):
            detail = np.minimum(level, levels.level_count[kind] - 1.0)
            row = levels.start[kind] + detail.astype(np.int32)
            ms = fixed_ms + costs.object_ms(linear[row], geometry[row], view).sum()
            if ms <= self.target_ms:
                break
        return Selection(view.ids, detail, Work(objects_visited=len(view)), predicted_ms=float(ms))
