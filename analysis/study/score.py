"""Replay one policy under one truth and score the run and its resamples.

What a worker process does.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError, PolicyError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ...policies.protocol import Policy, why_not_applicable
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.measured_frames import MeasuredFrames
from ..metrics.metric_registry import METRICS
from ..metrics.statistic import Statistic
from ..metrics.steps import Step, find_steps
from ..verdict.bootstrap import draw_blocks
from .engine.task import Beat, NotApplicableError

_SPAWN_KEY = 100
"""Apart from the keys 0, 1, ... that a replay spawns for its noise from the same seed."""


@dataclass(frozen=True, slots=True)
class World:
    """What all policies are replayed in."""

    scene: Scene
    trace: CameraTrace
    hardware: HardwareProfile
    options: ReplayOptions
    warmup: int

    def require_scored_frames(self) -> None:
        """Raise `InputError` if every frame would be warm-up, whatever the policy."""
        require_scored_frames(self.trace, self.options.frames, self.warmup)


def require_scored_frames(trace: CameraTrace, frames: int | None, warmup: int) -> None:
    """Raise `InputError` if every frame of a replay would be warm-up, whatever the policy."""
    # A trace without duration is replayed for one frame.
    frames = frames or (1 if trace.duration_s == 0.0 else None)
    if frames is not None and frames <= warmup:
        raise InputError(
            f"frames: expected more than the {warmup} of warm-up, got {frames}; "
            "take more frames or less warm-up"
        )


@dataclass(frozen=True, slots=True)
class Scored:
    """The scores of a replay.

    Attributes
    ----------
    log : FrameLog or None
        Where it was asked for.
    values : dict of str to float or None
        By metric id.
    resampled : dict of str to (R,) float64
        By metric id; missing where a metric has fewer than two frames that bear on it.
    steps : tuple of Step
        Answers to the steps in visible load.
    frames : int
        Frames replayed, warm-up included.
    """

    log: FrameLog | None
    values: dict[str, float | None]
    resampled: dict[str, FloatArray]
    steps: tuple[Step, ...]
    frames: int

    def __post_init__(self) -> None:
        # It may come from a process in which a policy replaced what makes it.
        if self.values.keys() != {metric.id for metric in METRICS}:
            raise ValueError("expected a value of every metric")
        if len({array.shape for array in self.resampled.values()}) > 1:
            raise ValueError("expected as many resamples of every metric")


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
    world: World,
    spec: PolicySpec,
    stream: int,
    resamples: int,
    *,
    keeps_log: bool,
    beat: Beat,
) -> Scored:
    """Replay and score (see `Run`); the same arguments give the same result in any process.

    Raises
    ------
    PolicyError
        If the policy breaks its contract, or has no frame after the warm-up.
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
    )
    if len(log) <= world.warmup:
        last, reason = len(log) - 1, f"{len(log)} frames, all of them warm-up; lower --warmup"
        raise PolicyError(spec.label, last, reason)
    frames = MeasuredFrames(log, world.warmup)
    statistics = {metric.id: metric(frames) for metric in METRICS}
    values = {name: None if item is None else item.value() for name, item in statistics.items()}
    resampled: dict[str, FloatArray] = {}
    if resamples:
        resampled = resample(frames, statistics, world.options.seed, stream, resamples)
    return Scored(log if keeps_log else None, values, resampled, find_steps(frames), len(log))


def resample(
    run: MeasuredFrames,
    statistics: Mapping[str, Statistic | None],
    seed: int,
    stream: int,
    count: int,
) -> dict[str, FloatArray]:
    """Return by metric its value in each resample, (count,); see `Scored.resampled`."""
    root = np.random.SeedSequence(seed, spawn_key=(_SPAWN_KEY, stream))
    known = {n: item for n, item in statistics.items() if item is not None and item.support > 1}
    found: dict[str, list[FloatArray]] = {name: [] for name in known}
    for sample in draw_blocks(root, count).samples(run.input_ns):
        for name, item in known.items():
            found[name].append(item.of(sample))
    return {name: np.concatenate(parts) for name, parts in found.items()}
