"""Replay one policy under one truth and score the run and its resamples.

What a worker process does: everything it needs arrives in one `World` and one `Job`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError, PolicyError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ...policies.protocol import why_not_applicable
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions, replay
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.measured_frames import Run
from ..metrics.metric_registry import METRICS
from ..metrics.statistic import Statistic
from ..metrics.steps import Step, find_steps
from ..verdict.bootstrap import draw_blocks

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
        # A trace without duration is replayed for one frame.
        frames = self.options.frames or (1 if self.trace.duration_s == 0.0 else None)
        if frames is not None and frames <= self.warmup:
            raise InputError(
                f"frames: expected more than the {self.warmup} of warm-up, got {frames}; "
                "give --frames more or --warmup less"
            )

    def why_not_applicable(self, policy: PolicySpec) -> str | None:
        """Return why a policy does not fit the scene, or None if it does."""
        return why_not_applicable(policy.make().capabilities, self.scene)


@dataclass(frozen=True, slots=True)
class Job:
    """One replay: of a policy, under the profile's mean or a posterior draw.

    Attributes
    ----------
    draw : index of the posterior draw, None for the mean
    stream : which blocks are drawn; the same for every policy, so that comparisons are paired
    resamples : number of resamples, 0 for none
    seed : root of noise and blocks
    """

    policy: PolicySpec
    draw: int | None
    stream: int
    resamples: int
    seed: int


@dataclass(frozen=True, slots=True)
class Scored:
    """A replay's log and scores, or why there are none.

    Attributes
    ----------
    failure : str or None
    log : FrameLog or None
        Only of a replay under the mean.
    values : dict of str to float or None
        By metric id.
    resampled : dict of str to (R,) float64
        By metric id; missing where a metric has fewer than two frames that bear on it.
    """

    failure: str | None = None
    log: FrameLog | None = None
    values: dict[str, float | None] = field(default_factory=dict[str, float | None])
    resampled: dict[str, FloatArray] = field(default_factory=dict[str, FloatArray])
    steps: tuple[Step, ...] = ()


def score(world: World, job: Job) -> Scored:
    """Replay and score; the same arguments give the same result in any process."""
    options = replace(world.options, draw=job.draw, seed=job.seed)
    try:
        policy, name = job.policy.make(), job.policy.label
        log = replay(policy, world.scene, world.trace, world.hardware, options, name=name)
    except PolicyError as error:
        return Scored(failure=_with_draw(error, job.draw))
    if len(log) <= world.warmup:
        return Scored(failure=f"{len(log)} frames, all of them warm-up; lower --warmup")
    run = Run(log, world.warmup)
    statistics = {metric.id: metric(run) for metric in METRICS}
    values = {name: None if item is None else item.value() for name, item in statistics.items()}
    resampled: dict[str, FloatArray] = {}
    if job.resamples:
        resampled = resample(run, statistics, job.seed, job.stream, job.resamples)
    kept = log if job.draw is None else None
    return Scored(None, kept, values, resampled, find_steps(run))


def resample(
    run: Run, statistics: Mapping[str, Statistic | None], seed: int, stream: int, count: int
) -> dict[str, FloatArray]:
    """Return by metric its value in each resample, (count,); see `Scored.resampled`."""
    root = np.random.SeedSequence(seed, spawn_key=(_SPAWN_KEY, stream))
    rows = draw_blocks(root, count).rows(run.input_ns)
    return {
        name: item.resampled(rows)
        for name, item in statistics.items()
        if item is not None and item.support > 1
    }


def _with_draw(error: PolicyError, draw: int | None) -> str:
    where = "reset" if error.frame is None else f"frame {error.frame}"
    which = "" if draw is None else f" of posterior draw {draw}"
    return f"{where}{which}: {error.reason}"
