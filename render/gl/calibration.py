"""What is drawn to calibrate a cost model: frames that spread every predictor apart.

A policy's own frames hold few objects at fine levels or many at coarse ones, so that counts move
together and a fit cannot tell their costs apart.  Here, block by block, levels are random, swing
all together from fine to coarse and back, or go by size as in games; a random share of the objects
is left out; the picture is rendered at several sizes; in some blocks objects are drawn in an order
that mixes types, so that state changes are as many as draws, where sorted they are as few as types;
and every other frame uploads a random number of bytes.

Within a block frames follow one another as under a policy, the same objects at nearly the same
levels: so what the model misses changes from frame to frame as it does there, and its correlation
in a fit is that of real frames.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...base.arrays import FloatArray
from ...models.scene.scene import Scene
from ...policies.protocol import Capabilities
from ...policies.selection import Selection
from ...policies.view import View

_BLOCK = 12  # frames
_SWING = 24  # frames from fine to coarse
_LEAST_SHARE = 6.0  # halvings of the share of objects that is drawn, at most
_RENDER_SCALES = (1.0, 1.0, 1.0, 0.75, 0.5, 0.25)
_KINDS = ("random", "swing", "size", "size")
_COARSENESS_LOG2 = (-3.0, 8.0)  # least, and how far it goes
_MIXED = 0.3  # share of blocks
_UPLOADS = 0.5  # share of frames
_UPLOAD_LOG2 = (12.0, 22.0)  # of bytes: a level of some hundred triangles to one of 100,000

# How far each of the six numbers of a block goes on, round and round, to the next: so few blocks
# cover them evenly together (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences",
# 2018: powers of the root of x^7 = x + 1).
_STEP = 1.1127756842787055 ** -np.arange(1.0, 7.0)


@dataclass(frozen=True, slots=True)
class Arrangement:
    """How a frame of the programme is drawn, beside what a selection says.

    Attributes
    ----------
    mixed, upload_bytes : as of `Picture`
    """

    mixed: bool
    upload_bytes: int


class Calibration:
    """Draws the programme, in a random order given by the seed; it heeds no budget.

    Attributes
    ----------
    arrangement : Arrangement
        Of the frame that was selected last.
    """

    capabilities: ClassVar[Capabilities] = Capabilities(continuous=True)

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Begin the programme anew."""
        # Two streams, so that what is uploaded changes nothing of what is seen.
        seen, uploaded = np.random.SeedSequence(self._seed).spawn(2)
        self._rng, self._upload_rng = np.random.default_rng(seen), np.random.default_rng(uploaded)
        self._place = self._rng.uniform(size=len(_STEP))
        self._levels = scene.types.levels
        self._count = len(scene)

    def select(self, view: View) -> Selection:
        """Return the next frame of the programme."""
        if view.frame % _BLOCK == 0:
            self._begin_block()
        keep = np.flatnonzero(self._lot[view.ids] < self._share)
        ids = view.ids[keep]
        levels, kind = self._levels, view.type_index[keep]
        last = levels.level_count[kind] - 1
        level = np.clip(np.rint(self._depth(view)[keep] * last), 0, last).astype(np.int32)
        knot = levels.resolution[levels.start[kind] + level]
        detail = np.where(levels.continuous[kind], knot, level.astype(np.float64))
        uploads, log2 = (
            self._upload_rng.random() < _UPLOADS,
            self._upload_rng.uniform(*_UPLOAD_LOG2),
        )
        self.arrangement = Arrangement(self._mixed, round(2.0**log2) if uploads else 0)
        return Selection(ids, detail, render_scale=self._scale)

    def _begin_block(self) -> None:
        self._place = (self._place + _STEP) % 1.0
        kind, share, scale, mixed, self._middle, coarseness = self._place.tolist()
        self._kind = _KINDS[int(kind * len(_KINDS))]
        self._share = 2.0 ** (-_LEAST_SHARE * share)
        self._scale = _RENDER_SCALES[int(scale * len(_RENDER_SCALES))]
        self._mixed = mixed < _MIXED
        self._coarseness = 2.0 ** (_COARSENESS_LOG2[0] + _COARSENESS_LOG2[1] * coarseness)
        self._lot, self._offset = self._rng.uniform(size=(2, self._count))

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
