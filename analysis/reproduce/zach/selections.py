"""`zach` as printed, on a flight over Styria: what it draws, takes, and is worth."""

import time

import numpy as np

from ....base.arrays import FloatArray
from ....models.machine.hardware import HardwareProfile
from ....models.machine.profile_catalog import load_hardware
from ....models.scene.scene import Scene
from ....models.scene.scene_catalog import load_scene
from ....policies.budgets.zach import Effort, Zach
from ....policies.protocol import Truth
from ....policies.selection import Selection
from ....policies.view import View
from ....sim.frame_log import FrameLog
from ....sim.machine.simulated_machine import FrameTimes, Submitted
from ....sim.replay import ReplayOptions, replay
from ...study.engine.task import Beat
from ..trial import Numbers
from .benefit import PaperBenefit
from .flight import LENGTH_S, flight

MACHINE, SCENE = "geforce2go-2002", "styria"
_MANY_STEPS = 1_000_000
_SPLAT_MS, _TREE_MS = 0.35e-3, 2.45e-3  # printed


class _Noting(Zach):
    """The policy, and of every frame what it took and what it is worth."""

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare."""
        super().reset(scene, budget_ms)
        self._benefit = PaperBenefit(scene)
        self.efforts: list[Effort] = []
        self.worth: list[tuple[float, float]] = []
        self.took_ms: list[float] = []
        self.trees: list[float] = []

    def select(self, view: View) -> Selection:
        """Return the policy's selection."""
        start = time.process_time()
        selection = super().select(view)
        self.took_ms.append(1e3 * (time.process_time() - start))
        self.efforts.append(self.effort)
        self.worth.append(self._benefit.of(view, selection))
        self.trees.append(self._benefit.trees_in_view(view))
        return selection


class _Paced:
    """Frames at even times along the path, whatever they cost."""

    def __init__(self, hardware: HardwareProfile, step_ms: float) -> None:
        self._hardware, self._step_ms = hardware, step_ms

    def begin(self) -> Truth:
        """Begin a frame."""
        return Truth(self._hardware.gpu, 1.0)

    def run(self, frame: Submitted) -> FrameTimes:
        """Let the step pass."""
        _, select_ms = self._hardware.cpu.frame_ms(frame.counts)
        return FrameTimes(select_ms, 1e-3, self._step_ms)


def measure(
    *,
    budget_ms: float,
    splitting: bool,
    frames: int,
    epsilon: float = 0.05,
    cull_px: float = 2.0,
    admission: bool = False,
    beat: Beat,
) -> Numbers:
    """Return lists over frames, evenly along the flight, and the median selection's time."""
    hardware, scene = load_hardware(MACHINE), load_scene(SCENE)
    policy = _Noting(
        splitting=splitting,
        epsilon=epsilon,
        cull_px=cull_px,
        admission=admission,
        max_steps=256 if admission else _MANY_STEPS,
    )
    options = ReplayOptions(budget_ms=budget_ms, frames=frames)
    machine = _Paced(hardware, 1e3 * LENGTH_S / frames)
    log = replay(
        policy, scene, flight(), hardware, options, name="zach", machine=machine, beat=beat
    )
    efforts = policy.efforts
    return {
        **_times(log),
        "groups": [effort.groups for effort in efforts],
        "variables": [effort.variables for effort in efforts],
        "steps": [effort.steps for effort in efforts],
        "passes": [effort.passes for effort in efforts],
        "terrain_benefit": [terrain for terrain, _ in policy.worth],
        "tree_benefit": [trees for _, trees in policy.worth],
        "trees_in_view": policy.trees,
        "wall_ms": float(np.median(policy.took_ms)),
    }


def replayed(*, budget_ms: float, seconds: float, beat: Beat) -> Numbers:
    """Return lists over the frames of the flight's first seconds on the machine itself."""
    hardware, scene = load_hardware(MACHINE), load_scene(SCENE)
    # Frames end with the path: of a shorter one there are fewer.
    trace = flight(seconds)
    policy = Zach(admission=False, max_steps=_MANY_STEPS)
    log = replay(
        policy, scene, trace, hardware, ReplayOptions(budget_ms=budget_ms), name="zach", beat=beat
    )
    return {**_times(log), "at_s": (log["input_ns"] * 1e-9).tolist()}


def _times(log: FrameLog) -> Numbers:
    """Return predicted and simulated times, in all and of the vegetation, and what was drawn."""
    simulated = log["model_gpu_ms"]
    trees_ms = _TREE_MS * (log["draw_calls"] - _patches(log)) + _SPLAT_MS * log["splats"]
    return {
        "predicted_ms": log["predicted_gpu_ms"].tolist(),
        "simulated_ms": simulated.tolist(),
        "trees_ms": trees_ms.tolist(),
        # What is predicted of the terrain is what it costs.
        "trees_predicted_ms": (log["predicted_gpu_ms"] - simulated + trees_ms).tolist(),
        "trees": (log["draw_calls"] - _patches(log)).tolist(),
        "splats": log["splats"].tolist(),
        "vertices": log["vertices"].tolist(),
        "select_ms": log["select_ms"].tolist(),
        "comparisons": log["comparisons"].tolist(),
    }


def _patches(log: FrameLog) -> FloatArray:
    """Return the patches drawn: each is 2,048 triangles, and nothing else has any."""
    triangles: FloatArray = log["triangles"]
    return triangles / 2_048.0
