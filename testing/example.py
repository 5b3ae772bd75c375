"""A small world in which a property is tried, and what a policy did in it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from ..models.machine.hardware import HardwareProfile
from ..models.scene.scene import Scene
from ..policies.protocol import Capabilities, Oracle, Policy, Truth
from ..policies.selection import Selection
from ..policies.view import View
from ..sim.frame_log import FrameLog
from ..sim.replay import ReplayOptions, replay
from ..traces.cameras.camera_trace import CameraTrace
from .checks.driver import coarsest, frame_ms

Factory = Callable[[], Policy]


@dataclass(frozen=True, slots=True, eq=False)
class Played:
    """A replay of an example.

    Attributes
    ----------
    log : FrameLog
    detail : list of dict of int to float
        By frame: the detail selected for each node.
    least_ms : list of float
        By frame: noise-free GPU time of the least that could be drawn.
    arrivals : list of int
        Frames, other than the first, in which other nodes were in memory than in the one before.
    """

    log: FrameLog
    detail: list[dict[int, float]]
    least_ms: list[float]
    arrivals: list[int]


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """A world without noise, a budget and a number of frames.

    `scene` is bound to the machine's costs, so that a policy may consult them.
    """

    scene: Scene
    trace: CameraTrace
    hardware: HardwareProfile
    budget_ms: float
    frames: int

    def __repr__(self) -> str:
        objects = "object" if len(self.scene) == 1 else "objects"
        frames = "frame" if self.frames == 1 else "frames"
        return (
            f"{len(self.scene)} {objects}, {self.frames} {frames}, budget {self.budget_ms:.4g} ms"
        )

    def play(self, policy: Policy) -> Played:
        """Replay the example under a policy.

        Raises
        ------
        PolicyError
            If the policy breaks its contract.
        """
        watched = _watch(policy)
        options = ReplayOptions(budget_ms=self.budget_ms, frames=self.frames)
        log = replay(
            watched, self.scene, self.trace, self.hardware, options, name=type(policy).__name__
        )
        return Played(log, watched.detail, watched.least_ms, watched.arrivals)


class _Watched:
    """A policy whose selections are noted."""

    capabilities: ClassVar[Capabilities]

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.detail: list[dict[int, float]] = []
        self.least_ms: list[float] = []
        self.arrivals: list[int] = []
        self._resident: bytes | None = None

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Reset the policy."""
        self._policy.reset(scene, budget_ms)

    def select(self, view: View) -> Selection:
        """Note the policy's selection, and what the coarsest one would have cost."""
        everything = view.state.residency
        resident = None if everything is None else everything.tobytes()
        if view.frame and resident != self._resident:
            self.arrivals.append(view.frame)
        self._resident = resident
        selection: Any = self._policy.select(view)
        if isinstance(selection, Selection):  # a user's policy may return anything
            pairs = zip(selection.ids.tolist(), selection.detail.tolist(), strict=True)
            self.detail.append(dict(pairs))
        self.least_ms.append(frame_ms(view, coarsest(view)))
        return selection


class _WatchedOracle(_Watched):
    """An oracle whose selections are noted."""

    def foresee(self, truth: Truth) -> None:
        """Pass the truth on."""
        assert isinstance(self._policy, Oracle), "only an oracle is watched as one"
        self._policy.foresee(truth)


def _watch(policy: Policy) -> _Watched:
    """Return a policy with the same capabilities, which belong to its class."""
    base = _WatchedOracle if isinstance(policy, Oracle) else _Watched
    watched: Any = type("Watched", (base,), {"capabilities": policy.capabilities})
    return watched(policy)
