"""Replay one policy under one truth and score the run: what a worker process does."""

from dataclasses import dataclass, field

from ...base.arrays import FloatArray
from ...base.errors import InputError, PolicyError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ...policies.protocol import Policy, why_not_applicable
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.footing import Footing, find_footing
from ..metrics.measured_frames import MeasuredFrames, require_window
from ..metrics.metric_registry import METRICS
from ..metrics.over_time import time_quantile
from ..metrics.steps import Step, find_steps
from ..metrics.worst_moment import Moment, find_worst_moment
from .added_costs import works_with_added
from .engine.task import Beat, NotApplicableError

MISS = 0.01
"""Share of time for which a policy may exceed the budget and still keep it."""


@dataclass(frozen=True, slots=True)
class World:
    """What all policies are replayed in.

    Attributes
    ----------
    warmup_s : float
        Seconds at the start of the path that no metric counts.
    miss : float
        Share of time for which the budget may be exceeded.
    """

    scene: Scene
    trace: CameraTrace
    hardware: HardwareProfile
    options: ReplayOptions
    warmup_s: float
    miss: float = MISS

    def require_window(self) -> None:
        """Raise `InputError` if all of the path would be warm-up, whatever the policy."""
        require_window(self.warmup_s, self.trace.duration_s)


@dataclass(frozen=True, slots=True)
class Scored:
    """The scores of a replay.

    Attributes
    ----------
    log : FrameLog or None
        Where it was asked for.
    values : dict of str to float or None
        By metric id.
    steps : tuple of Step
        Answers to the steps in visible load.
    frames : int
        Frames replayed, warm-up included.
    judged_ms : float
        Work time by which the budget is judged: its quantile over time, 1 - miss.
    worst : Moment
        When most work was done.
    footing : Footing
        What there was to tell policies apart by.
    added_ms : dict of str to float
        As `judged_ms`, with each cost that nobody measured (see `added_costs`), by its name.
    """

    log: FrameLog | None
    values: dict[str, float | None]
    steps: tuple[Step, ...]
    frames: int
    judged_ms: float
    worst: Moment
    footing: Footing
    added_ms: dict[str, float] = field(default_factory=dict[str, float])

    def __post_init__(self) -> None:
        # It may come from a process in which a policy replaced what makes it.
        if self.values.keys() != {metric.id for metric in METRICS}:
            raise ValueError("expected a value of every metric")


def make_fit(spec: PolicySpec, scene: Scene) -> Policy:
    """Return a policy that fits a scene.

    Raises `NotApplicableError` if it does not, and `InputError` if its class refuses the
    parameters.
    """
    policy = spec.make()
    unfit = why_not_applicable(policy.capabilities, scene)
    if unfit is not None:
        raise NotApplicableError(unfit)
    return policy


def score(
    world: World, spec: PolicySpec, *, keeps_log: bool, beat: Beat, keeps_levels: bool = False
) -> Scored:
    """Replay and score (see `Run`); the same arguments give the same result in any process.

    Raises
    ------
    PolicyError
        If the policy breaks its contract, or has no frame in the window.
    NotApplicableError
        If it does not fit the scene.
    InputError
        If its class refuses the parameters.
    """
    log = replay(
        make_fit(spec, world.scene),
        world.scene,
        world.trace,
        world.hardware,
        world.options,
        name=spec.label,
        beat=beat,
        keeps_levels=keeps_levels,
    )
    frames = measure(log, world.trace, world.warmup_s)
    values = {metric.id: metric(frames) for metric in METRICS}
    quantile = 1.0 - world.miss

    def judge(work_ms: FloatArray) -> float:
        judged_ms = time_quantile(work_ms, frames.cost_weight_ms, quantile)
        # Frames that are not shown within the window weigh nothing there: then each counts once.
        return float(work_ms.max()) if judged_ms is None else judged_ms

    added = works_with_added(frames, world.hardware)
    return Scored(
        log=log if keeps_log else None,
        values=values,
        steps=find_steps(frames),
        frames=len(log),
        judged_ms=judge(frames.work_ms),
        worst=find_worst_moment(frames, world.hardware),
        footing=find_footing(frames, quantile),
        added_ms={name: judge(work_ms) for name, work_ms in added},
    )


def measure(log: FrameLog, trace: CameraTrace, warmup_s: float) -> MeasuredFrames:
    """Return the frames that count of a replay of a path.

    Raises `PolicyError` if there are none, since then its frames were too slow for the path.
    """
    require_window(warmup_s, trace.duration_s)
    try:
        return MeasuredFrames(log, warmup_s, trace.duration_s)
    except InputError as error:
        raise PolicyError(log.header.policy, len(log) - 1, error.message) from error
