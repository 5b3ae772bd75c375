"""``static-screen``: level from projected height against thresholds."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...models.scene.nodes import Nodes
from ...models.scene.scene import Scene
from ..knob import Knob
from ..protocol import Capabilities, Claims
from ..selection import Selection, Work
from ..shared.levels.discretise import detail_of_level, level_of_detail
from ..shared.ranges import Fraction, NotNegative, Positive, check_parameters
from ..view import View

_ROUNDING = 1e-12  # above that of a distance, relative


def screen_height(view: View, bias: float = 1.0) -> FloatArray:
    """Return each bounding sphere's diameter over the height of the screen at its distance, (m,).

    Unity's ``size / (distance · 2 tan(fov / 2))``, times its LOD bias; where the vertical field of
    view is the narrower one it is also Unreal's screen size.  The distance is at least the radius,
    so that a sphere around the eye has a finite height.
    """
    camera = view.camera
    return _height(view.distance_m, view.radius_m, 2.0 * camera.focal_px / camera.height_px * bias)


def _height(distance_m: FloatArray, radius_m: FloatArray, per_ratio: float) -> FloatArray:
    """Return the heights of spheres, `per_ratio` times radius over distance, (m,)."""
    height = np.maximum(distance_m, radius_m)
    np.divide(radius_m, height, out=height)
    height *= per_ratio
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
    """The candidates' levels, and between which distances each may stay at its own."""

    nodes: Nodes
    frame: int
    selection: Selection
    near_m: FloatArray
    far_m: FloatArray


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
    knob: ClassVar[Knob] = Knob("bias", 0.005, 50.0)

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
        # Level i gives way to i + 1 below the i-th height, and to i - 1 from another height on.
        # As radii over distances; rounded so that what may change is always looked at.
        self._far = (1.0 - _ROUNDING) / threshold
        self._near = np.zeros(most)
        self._near[1:] = (1.0 + _ROUNDING) / (threshold[:-1] + self.hysteresis)
        # Of each node, as last drawn: its level, and up to and above which distance it may change,
        # for a sphere as high as its radius over its distance.
        n = len(scene) if self._discrete else 0
        self._levels = np.full(n, np.nan)
        self._bounds_m = np.full((2, n), np.nan)
        self._bounds_m[0] = np.inf  # what was never drawn has no distances to stay in
        self._kept: _Kept | None = None
        self._alone = True  # whether all that was ever drawn was chosen here

    def select(self, view: View) -> Selection:
        """Return a level for every candidate."""
        return self.select_biased(view, self.bias)

    def select_biased(self, view: View, bias: float) -> Selection:
        """Return a level for every candidate under another bias than the policy's own."""
        if self._discrete:  # levels are details there, and can be gone on from
            return self._go_on(view, bias)
        nodes, table = view.nodes, view.scene.types.levels
        before = level_of_detail(table, nodes.type_index, view.previous_detail)
        level = self._level(screen_height(view, bias), nodes.coarsest_level, before)
        detail = detail_of_level(table, nodes.type_index, level)
        return Selection(view.ids, detail, Work(objects_visited=len(view.ids)))

    def _level(self, height: FloatArray, coarsest: FloatArray, before: FloatArray) -> FloatArray:
        """Return levels by heights and the levels before, NaN of what was never drawn, (m,)."""
        level = screen_level(height, coarsest, self.first, self.ratio)
        if self.hysteresis:
            # Only where it would become finer, and only as far as it would with the margin taken
            # off too; a comparison with NaN is false.
            at = (level < before).nonzero()[0]
            if len(at):
                lower = np.maximum(height.take(at) - self.hysteresis, 1e-9)
                late = screen_level(lower, coarsest.take(at), self.first, self.ratio)
                level[at] = np.minimum(late, before.take(at))
        return level

    def _go_on(self, view: View, bias: float) -> Selection:
        """Return levels, found anew only where candidates have left their distances."""
        kept, camera = self._kept, view.camera
        if kept is None:
            self._alone = bool(np.isnan(view.state.last_detail).all())
        elif view.previous is not kept.selection:
            self._alone = False
        if kept is None or kept.nodes is not view.nodes or kept.frame != view.frame - 1:
            kept = self._kept = self._recall(view)
        kept.frame = view.frame
        per_ratio = 2.0 * camera.focal_px / camera.height_px * bias
        distance_m = view.distance_m
        if per_ratio < self.first:  # else no sphere is too small with the eye at its surface
            distance_m = np.maximum(distance_m, view.radius_m)
        distance_m = distance_m * (1.0 / per_ratio)
        changes = distance_m > kept.far_m
        changes |= distance_m <= kept.near_m
        at = changes.nonzero()[0]
        if len(at):
            self._change(kept, at, view.distance_m.take(at), per_ratio)
        return kept.selection

    def _recall(self, view: View) -> _Kept:
        """Return the levels that candidates were last drawn at, and the distances of these."""
        nodes, before = view.nodes, view.previous_detail
        near_m, far_m = self._bounds_m.take(nodes.at, axis=1)
        if not self._alone:
            # What was drawn at a level that somebody else chose has no distances to stay in.
            near_m[before != self._levels.take(nodes.at)] = np.inf
        selection = Selection(view.ids, before, Work(objects_visited=len(view.ids)))
        return _Kept(nodes, view.frame, selection, near_m, far_m)

    def _change(
        self, kept: _Kept, at: NDArray[np.intp], distance_m: FloatArray, per_ratio: float
    ) -> None:
        """Find the levels of some candidates anew."""
        nodes, scene = kept.nodes.at.take(at), kept.nodes.scene
        coarsest, radius_m = scene.coarsest_level.take(nodes), scene.radius_m.take(nodes)
        level = kept.selection.detail.copy()  # others may still hold the selection before
        some = self._level(_height(distance_m, radius_m, per_ratio), coarsest, level.take(at))
        near_m, far_m = self._bounds(some, coarsest, radius_m)
        level[at], kept.near_m[at], kept.far_m[at] = some, near_m, far_m
        self._levels[nodes] = some
        self._bounds_m[0][nodes], self._bounds_m[1][nodes] = near_m, far_m
        ids = kept.selection.ids
        kept.selection = Selection(ids, level, Work(objects_visited=len(ids)))

    def _bounds(
        self, level: FloatArray, coarsest: FloatArray, radius_m: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the distances from above which and up to which levels stay, (m,) each."""
        at = level.astype(np.intp)
        # Nothing is coarser than the coarsest level.
        far = np.where(level < coarsest, self._far.take(at), np.inf)
        return radius_m * self._near.take(at), radius_m * far
