"""How bad a policy is on a camera path, measured in processes apart, path after path."""

from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, TypeAlias

from ...base.content_hash import content_hash
from ...base.errors import InputError, PolicyError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.metric_registry import find_metric
from .engine.limits import Limits
from .engine.open_engine import open_engine
from .engine.task import Beat, Inputs
from .score import make_fit, measure

Badness = Literal["overshoot", "toggles", "lag"]
METRIC_OF: dict[Badness, str] = {
    "overshoot": "work_ms_max",
    "toggles": "toggles_per_s",
    "lag": "lag_ms_p99",
}
"""The metric that each kind of badness is; the overshoot is over the budget."""

GUARD_OF: dict[Badness, str] = {**METRIC_OF, "overshoot": "work_ms_p99"}
"""The metric by which a path that was found is guarded: none that one frame decides."""

Gauge: TypeAlias = Callable[[CameraTrace], float]
"""Returns how bad a policy is on a path: the more the worse."""


def check_badness(text: str) -> Badness:
    """Return the kind of badness of that name.

    Raises `InputError` if there is none.
    """
    for name in METRIC_OF:
        if name == text:
            return name
    raise InputError(f"badness: expected {', '.join(METRIC_OF)}, got {text}; name one")


@dataclass(frozen=True, slots=True)
class PathRun:
    """One policy on one path (a `Task`).

    Attributes
    ----------
    policy : PolicySpec
    scene, hardware : str
        Content hashes of the inputs.
    trace : CameraTrace
    options : ReplayOptions
    badness : Badness
    warmup_s : float
        Seconds at the start of the path that do not count.
    """

    policy: PolicySpec
    scene: str
    hardware: str
    trace: CameraTrace
    options: ReplayOptions
    badness: Badness
    warmup_s: float

    result_type: ClassVar[Any] = float

    @property
    def owner(self) -> str:
        """The policy's label (see `Task`)."""
        return self.policy.label

    def __call__(self, inputs: Inputs, beat: Beat) -> float:
        """Replay and measure (see `Task`)."""
        scene = inputs[self.scene]
        policy = make_fit(self.policy, scene)
        hardware, label = inputs[self.hardware], self.policy.label
        log = replay(policy, scene, self.trace, hardware, self.options, name=label, beat=beat)
        value = find_metric(METRIC_OF[self.badness])(measure(log, self.trace, self.warmup_s)) or 0.0
        return value / self.options.budget_ms if self.badness == "overshoot" else value


@contextmanager
def open_gauge(
    spec: PolicySpec,
    scene: Scene,
    hardware: HardwareProfile,
    options: ReplayOptions,
    badness: Badness,
    *,
    warmup_s: float = 1.0,
    limits: Limits | None = None,
    scheduler: str | None = None,
) -> Generator[Gauge]:
    """Yield what measures a policy, in one process for all paths.

    Measuring raises `PolicyError` if the policy breaks its contract, and `InputError` if it does
    not fit the scene.
    """
    spec.check_parameters()
    inputs = {content_hash(value): value for value in (scene, hardware)}
    scene_hash, hardware_hash = inputs
    with open_engine(inputs, workers=1, limits=limits, scheduler=scheduler) as engine:

        def measure(trace: CameraTrace) -> float:
            task = PathRun(spec, scene_hash, hardware_hash, trace, options, badness, warmup_s)
            (outcome,) = engine.run([task])
            failure = outcome.failure
            if failure is None:
                return outcome.result
            if failure.kind == "not-applicable":
                raise InputError(f"policy {spec.label}: expected one that fits; {failure.reason}")
            raise PolicyError(spec.label, failure.frame, failure.reason)

        yield measure
