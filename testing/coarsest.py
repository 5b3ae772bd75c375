"""The least that can be drawn of a view, and its time by the simulator's own accounting."""

import numpy as np

from ..models.machine.cost import CostModel
from ..models.scene.benefit import level_primitives
from ..policies.selection import Selection
from ..policies.view import View
from ..sim.accounting.accounting import Accounting
from .example import Frame


def coarsest(view: View) -> Selection:
    """Return the least that a view can be drawn with: roots, or what an empty root stands above."""
    scene = view.scene
    levels = scene.types.levels
    empty = level_primitives(levels)[levels.start[:-1]][scene.type_index] == 0.0
    empty &= np.diff(scene.child_start) > 0
    front = view.ids
    while empty[front].any():
        below = [scene.children(node) for node in front[empty[front]].tolist()]
        front = np.concatenate((front[~empty[front]], *below)).astype(np.int32)
    front = front[view.state.inside[front]]
    kind = scene.type_index[front]
    coarse = np.where(
        levels.continuous[kind], levels.min_resolution[kind], levels.level_count[kind] - 1.0
    )
    return Selection(front, coarse)


def least_ms(frames: list[Frame], costs: CostModel) -> np.ndarray:
    """Return the noise-free GPU time of the coarsest selection of each frame, (n,)."""
    if not frames:
        return np.zeros(0)
    first = frames[0].view
    accounting = Accounting(first.scene, costs, 0, first.camera)
    tallies = [accounting.tally(0, accounting.drawn(coarsest(f.view), f.view)) for f in frames]
    return np.array([tally.gpu_ms for tally in tallies])
