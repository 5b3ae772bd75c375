"""``pixel-error``: coarsest level whose error on the screen is below a threshold."""

from dataclasses import dataclass
from typing import ClassVar

from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection
from ..shared.levels.error_ladder import ErrorLadder
from ..shared.ranges import BelowOne, Finite, check_parameters
from ..view import View


@dataclass
class PixelError:
    """Idea: draw the coarsest level whose geometric error is at most `threshold_px` on the screen.

    Error on the screen is ``error · scale · focal length / distance``, the distance to the nearest
    point of the bounding sphere and never below the near plane.  A node goes to a finer level as
    soon as its error passes the threshold, and back to a coarser one only where that one's error is
    below the threshold by the `hysteresis` share.  Levels of continuous types are their knots.

    Uses: errors of levels, distance, field of view.

    Parameters: as below.

    Cost per frame: O(n L), one visit an object.

    Reference: Godot's mesh LOD (``mesh_lod/lod_change/threshold_pixels``) and meshoptimizer's
    advice for its error metric; Cesium's screen-space error is the same formula with a threshold
    of 16 px.
    """

    threshold_px: Finite = 1.0  # Godot's and meshoptimizer's
    hysteresis: BelowOne = 0.0  # share of the threshold to coarsen late by; no engine has any

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)
    knob: ClassVar[Knob] = Knob("threshold_px", 0.05, 64.0, finer="lower")

    @property
    def claims(self) -> Claims:
        """What holds with these parameters."""
        return Claims(settles_frames=0, hysteresis=self.hysteresis > 0.0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Check parameters and tabulate the errors."""
        check_parameters(self, "pixel-error")
        self._ladder = ErrorLadder(scene)

    def select(self, view: View) -> Selection:
        """Return a level for every candidate."""
        return self._ladder.select(view, self.threshold_px, self.hysteresis)
