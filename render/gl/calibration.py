"""What is drawn to calibrate a cost model: frames that spread every predictor apart.

A policy's own frames hold few objects at fine levels or many at coarse ones, so that counts move
together and a fit cannot tell their costs apart.  Here, block by block, levels are random, swing
all together from fine to coarse and back, or go by size as in games; a random share of the objects
is left out; and the picture is rendered at several sizes.

Within a block frames follow one another as under a policy, the same objects at nearly the same
levels: so what the model misses changes from frame to frame as it does there, and its correlation
in a fit is that of real frames.
"""

from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ...policies.protocol import Capabilities
from ...policies.selection import Selection
from ...policies.view import View

_BLOCK = 12  # frames
_SWING = 24  # frames from fine to coarse
_LEAST_SHARE = 4.0  # halvings of the share of objects that is drawn, at most
_RENDER_SCALES = (1.0, 1.0, 1.0, 0.75, 0.5)
_KINDS = ("random", "swing", "size", "size")


class Calibration:
    """Draws the programme, in a random order given by the seed; it heeds no budget."""

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Begin the programme anew."""
        self._rng = np.random.default_rng(self._seed)
        self._levels = scene.types.levels
        self._count = len(scene)

    def select(self, view: View) -> Selection:
        """Return the next frame of the programme."""
        if view.frame % _BLOCK == 0:
            self._kind = _KINDS[self._rng.integers(len(_KINDS))]
            self._share = 2.0 ** -self._rng.uniform(0.0, _LEAST_SHARE)
            self._scale = _RENDER_SCALES[self._rng.integers(len(_RENDER_SCALES))]
            self._middle = self._rng.uniform()
            self._coarseness = 2.0 ** self._rng.uniform(-3.0, 5.0)
            self._lot, self._offset = self._rng.uniform(size=(2, self._count))
        keep = np.flatnonzero(self._lot[view.ids] < self._share)
        ids = view.ids[keep]
        levels, kind = self._levels, view.type_index[keep]
        last = levels.level_count[kind] - 1
        level = np.clip(np.rint(self._depth(view)[keep] * last), 0, last).astype(np.int32)
        knot = levels.resolution[levels.start[kind] + level]
        detail = np.where(levels.continuous[kind], knot, level.astype(np.float64))
        return Selection(ids, detail, render_scale=self._scale)

    def _depth(self, view: View) -> FloatArray:
        """Return how coarse each candidate is drawn, 0 for finest to 1 for coarsest."""
        count = len(view)
        if self._kind == "random":
            return self._middle + self._offset[view.ids] - 0.5
        if self._kind == "swing":
            turn = np.pi * (view.frame / _SWING + self._middle)
            return np.full(count, 0.5 - 0.5 * np.cos(turn))
        # One level coarser where the height halves; about ten halvings lie between near and far.
        height_px = np.sqrt(view.area_px)
        return (
            np.log2(self._coarseness * view.camera.height_px / np.maximum(height_px, 1e-3)) / 10.0
        )
