"""Policies with one thing wrong each."""

import numpy as np

from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection
from lodbench.policies.view import View


class Finest:
    """Not broken but blind to the budget: every object at its finest level."""

    capabilities = Capabilities()

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Note what there is."""
        self.coarsest = scene.types.levels.level_count.astype(np.float64) - 1.0
        self.budget_ms = budget_ms

    def select(self, view: View) -> Selection:
        """Draw the finest level."""
        return Selection(view.ids, np.zeros(len(view.ids)))

    def at_most(self, view: View, level: float) -> Selection:
        """Draw one level, or the coarsest where there are not so many."""
        return Selection(view.ids, np.minimum(level, self.coarsest[view.type_index]))


class Oscillating(Finest):
    """Draws the finest and the next level in turns."""

    def select(self, view: View) -> Selection:
        """Switch."""
        return self.at_most(view, view.frame % 2)


class OrderDependent(Finest):
    """Draws the first object as fine as can be, whichever that is."""

    def select(self, view: View) -> Selection:
        """Favour the lowest index."""
        coarse = self.coarsest[view.type_index]
        return Selection(view.ids, np.where(np.arange(len(view.ids)) == 0, 0.0, coarse))


class Leaking(Finest):
    """Draws coarser levels the more frames it has ever seen."""

    def __init__(self) -> None:
        self.frames = 0

    def select(self, view: View) -> Selection:
        """Count, and never forget."""
        self.frames += 1
        return self.at_most(view, self.frames // 3)


class SlowToSettle(Finest):
    """Goes down by a level every fourth frame after the view has changed."""

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Start in full detail."""
        super().reset(scene, budget_ms)
        self.level = 0.0

    def select(self, view: View) -> Selection:
        """Take time."""
        self.level += 0.25 if len(view.ids) else 0.0
        return self.at_most(view, np.floor(self.level))


class Spoilt(Finest):
    """Draws worse what it has more time for."""

    def select(self, view: View) -> Selection:
        """Slack."""
        return self.at_most(view, np.floor(self.budget_ms))


class Random(Finest):
    """Draws by lot, and not from a seed."""

    def select(self, view: View) -> Selection:
        """Throw dice."""
        return self.at_most(view, float(np.random.default_rng().integers(0, 3)))


class Invalid(Finest):
    """Breaks the contract when three objects are in view."""

    def select(self, view: View) -> Selection:
        """Return NaN."""
        return Selection(view.ids, np.full(len(view.ids), np.nan if len(view.ids) > 2 else 0.0))
