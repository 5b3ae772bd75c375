"""How far the levels shown are from those wanted, watched beside the policy."""

import numpy as np

from ....base.arrays import FloatArray, IntArray
from ....models.scene.scene import Scene
from ....models.scene.scene_catalog import load_scene
from ....policies.registry import parse_policy
from ....policies.selection import Selection
from ....policies.shared.observer import Watched, watch
from ....policies.view import View
from ....sim.replay import replay
from ....sim.replay_options import ReplayOptions
from ...study.engine.task import Beat
from ...study.stages import find_stage
from ..trial import Numbers
from .frame_rates import SETTLED_S
from .machine import CHANGED_NS, FAR_M, NEAR_M, machine


class _Watch(Watched):
    """Compares each selection with what the distances ask for."""

    def prepare(self, scene: Scene, slots: int) -> None:
        """Take the scene, and how many slots similar levels share."""
        self._slots = slots
        self._waiting = np.zeros(len(scene), dtype=np.int32)
        self.off: list[float] = []
        self.dissimilar: list[float] = []
        self.waits: list[IntArray] = []
        self.visited: list[int] = []
        self.new: list[int] = []
        self._seen = np.zeros(len(scene), dtype=np.bool_)

    def select(self, view: View) -> Selection:
        """Let the policy select, and compare."""
        selection = super().select(view)
        lod = np.clip((FAR_M - view.distance_m) / (FAR_M - NEAR_M), 0.0, 1.0)
        low = view.scene.types.levels.min_resolution[view.type_index]
        shown: FloatArray = (selection.detail - low) / (1.0 - low)
        wrong = self._slot(lod) != self._slot(shown)
        if view.time_ns * 1e-9 >= SETTLED_S:
            self.off.append(float(np.abs(lod - shown).mean()) if len(lod) else 0.0)
            self.dissimilar.append(float(wrong.mean()) if len(lod) else 0.0)
            waited = self._waiting[view.ids]
            self.waits.append(waited[(waited > 0) & ~wrong])
            self.visited.append(selection.work.objects_visited)
            self.new.append(int(np.count_nonzero(~self._seen[view.ids])))
        self._seen[view.ids] = True
        waiting = np.zeros_like(self._waiting)
        waiting[view.ids] = np.where(wrong, self._waiting[view.ids] + 1, 0)
        self._waiting = waiting
        return selection

    def _slot(self, lod: FloatArray) -> IntArray:
        # A level is drawn from its factor and back: between them lies rounding.
        return np.minimum(np.trunc(lod * self._slots + 1e-9), self._slots - 1).astype(np.int32)


def measure(
    *, policy: str, slots: int, path: str, seed: int, seconds: float, beat: Beat
) -> Numbers:
    """Return how similar levels are along a path through the ogres, and what it takes."""
    scene = load_scene("ogres")
    trace = find_stage(scene).move(path, seconds + SETTLED_S, seed)
    spec = parse_policy(policy)
    watched = watch(spec.make(), _Watch)
    watched.prepare(scene, slots)
    hardware = machine(0.0, CHANGED_NS, whole=False)
    options = ReplayOptions(budget_ms=33.3, seed=seed)
    log = replay(watched, scene, trace, hardware, options, name=spec.label, beat=beat)
    counts = log["input_ns"] * 1e-9 >= SETTLED_S
    waits = np.concatenate(watched.waits) if watched.waits else np.zeros(0)
    return {
        "off": float(np.mean(watched.off)),
        "off_max": float(np.max(watched.off)),
        "dissimilar": float(np.mean(watched.dissimilar)),
        "wait_mean": float(waits.mean()) if len(waits) else 0.0,
        "wait_max": float(waits.max()) if len(waits) else 0.0,
        "visited": float(np.mean(watched.visited)),
        "visited_beyond_new": float(np.max(np.subtract(watched.visited, watched.new))),
        "in_view": float(log["visible"][counts].mean()),
        "extracted": float(log["levels_extracted"][counts].mean()),
        "borrowed": float(log["levels_borrowed"][counts].mean()),
        "select_ms": float(log["select_ms"][counts].mean()),
    }
