"""``static-screen``: level from projected height against thresholds."""

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.nodes import Nodes
from ...models.scene.scene import Scene
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.discretise import detail_of_level, level_of_detail
from ..shared.ranges import Fraction, NotNegative, Positive, check_parameters
from ..view import View


def screen_height(view: View, bias: float = 1.0) -> FloatArray:
    """Return each bounding sphere's diameter over the height of the screen at its distance, (m,).

    Unity's ``size / (distance · 2 tan(fov / 2))``, times its LOD bias; where the vertical field of
    view is the narrower one it is also Unreal's screen size.  The distance is at least the radius,
    so that a sphere around the eye has a finite height.
    """
    camera = view.camera
    height = np.maximum(view.distance_m, view.radius_m)
    np.divide(view.radius_m, height, out=height)
    height *= 2.0 * camera.focal_px / camera.height_px * bias
    return height


def screen_level(
    height: FloatArray, coarsest: FloatArray, first: float, ratio: float
) -> FloatArray:
    """Return the level whose threshold a height still reaches: ``first · ratio^level``, (m,)."""
    level = height / first
    np.log(level, out=level)
    level /= math.log(ratio)
    np.ceil(level, out=level)
    np.maximum(level, 0.0, out=level)
    return np.minimum(level, coarsest, out=level)


@dataclass(slots=True)
class _Kept:
    """Levels of the last frame's candidates, and between which heights each stays at its own."""

    nodes: Nodes
    frame: int
    level: FloatArray
    leaves: FloatArray = field(default_factory=lambda: np.zeros(0))
    returns: FloatArray = field(default_factory=lambda: np.zeros(0))


@dataclass
class StaticScreen:
    """Idea: level i is drawn while projected height is at least ``first · ratio^i`` of the screen.

    A node goes to a coarser level at the threshold S and returns at ``S + hysteresis``, as in
    Unreal.  Levels of continuous types are their knots.

    Uses: distance and radius of the bounding sphere, field of view.

    Parameters: `first` (height from which the finest level is drawn), `ratio` (of successive
    thresholds), `bias` (multiplies heights, Unity's lodBias), `hysteresis` (of the screen height).

    Cost per frame: O(n), one visit an object.

    Reference: Unity's LODGroup (relative height, no hysteresis) and Unreal's static mesh screen
    size with LODHysteresis.  Thresholds are authored per asset there; a geometric ladder is ours.
    """

    first: Positive = 0.25  # ours: no engine ships a value that fits every asset
    ratio: Fraction = 0.5  # ours: halving the height when the triangles halve or quarter
    bias: Positive = 1.0  # Unity's default
    hysteresis: NotNegative = 0.01  # ours; 0 is Unity's behaviour

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        return Claims(settles_frames=0, hysteresis=self.hysteresis > 0.0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and tabulate the heights at which levels change."""
        check_parameters(self, "static-screen")
        self._discrete = not scene.types.levels.continuous.any()
        most = int(scene.types.levels.level_count.max())
        threshold = self.first * self.ratio ** np.arange(most)
        # Of level i: the height below which it gives way to i + 1, and from which to i - 1.
        self._leaves = threshold
        self._returns = np.concatenate(([np.inf], threshold[:-1] + self.hysteresis))
        self._kept: _Kept | None = None

    def select(self, view: View) -> Selection:
        """Return a level for every candidate."""
        return self.select_biased(view, self.bias)

    def select_biased(self, view: View, bias: float) -> Selection:
        """Return a level for every candidate under another bias than the policy's own."""
        height = screen_height(view, bias)
        kept, nodes = self._kept, view.nodes
        if kept is None or kept.nodes is not nodes or kept.frame != view.frame - 1:
            table = view.scene.types.levels
            before = level_of_detail(table, nodes.type_index, view.previous_detail)
            level = self._level(height, nodes.coarsest_level, before)
            detail = detail_of_level(table, nodes.type_index, level)
            # Levels of a discrete scene are their details, and can be gone on from.
            self._kept = _Kept(nodes, view.frame, level) if self._discrete else None
            return Selection(view.ids, detail, Work(objects_visited=len(view.ids)))
        if not len(kept.leaves):
            kept.leaves, kept.returns = self._bounds(kept.level, nodes.coarsest_level)
        self._go_on(kept, height)
        return Selection(view.ids, kept.level, Work(objects_visited=len(view.ids)))

    def _level(self, height: FloatArray, coarsest: FloatArray, before: FloatArray) -> FloatArray:
        """Return levels by heights and the levels before, NaN of what was never drawn, (m,)."""
        level = screen_level(height, coarsest, self.first, self.ratio)
        if self.hysteresis:
            # Only where it would become finer, and only as far as it would with the margin taken
            # off too; a comparison with NaN is false.
            at = (level < before).nonzero()[0]
            lower = np.maximum(height.take(at) - self.hysteresis, 1e-9)
            late = screen_level(lower, coarsest.take(at), self.first, self.ratio)
            level[at] = np.minimum(late, before.take(at))
        return level

    def _bounds(self, level: FloatArray, coarsest: FloatArray) -> tuple[FloatArray, FloatArray]:
        at = level.astype(np.intp)
        # Nothing is coarser than the coarsest level.
        return np.where(level < coarsest, self._leaves.take(at), 0.0), self._returns.take(at)

    def _go_on(self, kept: _Kept, height: FloatArray) -> None:
        """Change the levels of candidates whose heights have left their bounds."""
        kept.frame += 1
        changes = height < kept.leaves
        changes |= height >= kept.returns
        at = changes.nonzero()[0]
        if not len(at):
            return
        coarsest = kept.nodes.coarsest_level.take(at)
        some = self._level(height.take(at), coarsest, kept.level.take(at))
        # A new array: the one before is a selection that others may still hold.
        kept.level = kept.level.copy()
        kept.level[at] = some
        kept.leaves[at], kept.returns[at] = self._bounds(some, coarsest)
