"""``static-screen``: level from projected height against thresholds."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray
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
        """Check parameters."""
        check_parameters(self, "static-screen")

    def select(self, view: View) -> Selection:
        """Return a level for every candidate."""
        return self.select_biased(view, self.bias)

    def select_biased(self, view: View, bias: float) -> Selection:
        """Return a level for every candidate under another bias than the policy's own."""
        table, nodes = view.scene.types.levels, view.nodes
        height = screen_height(view, bias)
        coarsest = nodes.coarsest_level
        level = screen_level(height, coarsest, self.first, self.ratio)
        if self.hysteresis:
            before = level_of_detail(table, nodes.type_index, view.previous_detail)
            # Only where it would become finer, and only as far as it would with the margin taken
            # off too.  NaN, never drawn before, compares false.
            at = (level < before).nonzero()[0]
            lower = np.maximum(height.take(at) - self.hysteresis, 1e-9)
            late = screen_level(lower, coarsest.take(at), self.first, self.ratio)
            level[at] = np.minimum(late, before.take(at))
        detail = detail_of_level(table, nodes.type_index, level)
        return Selection(view.ids, detail, Work(objects_visited=len(view.ids)))
