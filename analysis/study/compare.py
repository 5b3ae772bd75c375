"""Compare policies: replay each in the same world and score all on the same footing."""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ...policies.registry import require_distinct
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.metric_registry import METRICS
from ..verdict.bootstrap import BLOCKS
from ..verdict.pareto import find_front
from ..verdict.uncertainty import LEVEL, Pool, beats, interval, pool_of
from .comparison import Comparison, Intervals, PolicyResult, ReplayConditions, Score
from .score import Job, Scored, World
from .workers import RunJobs, started

Progress = Callable[[int, int], None]
"""Called with the replays done and the replays in all."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CompareOptions:
    """How to score.

    Attributes
    ----------
    warmup : int
        Frames at the start of each replay that no metric counts.
    resamples : int
        Bootstrap resamples, over all draws.
    draws : int
        Posterior draws of the cost model to replay, if the profile has them.
    workers : int
        Processes; 0 for as many as there are processors.  Results do not depend on it.
    """

    warmup: int = 30
    resamples: int = 200
    draws: int = 16
    workers: int = 0

    def __post_init__(self) -> None:
        for name, low in (("warmup", 0), ("resamples", 1), ("draws", 0), ("workers", 0)):
            value = getattr(self, name)
            if value < low:
                raise InputError(f"{name}: expected a whole number >= {low}, got {value}")


def compare(
    policies: Sequence[PolicySpec],
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    replay_options: ReplayOptions,
    options: CompareOptions | None = None,
    *,
    progress: Progress | None = None,
) -> tuple[Comparison, dict[str, FrameLog]]:
    """Replay and score policies; return the comparison, and each frame log by label.

    A policy that breaks its contract is reported as failed, and the others are finished.

    Raises `InputError` if a policy is given twice, its parameters are refused, or all frames would
    be warm-up.
    """
    options = options or CompareOptions()
    world = World(scene, trace, hardware, replay_options, options.warmup)
    world.require_scored_frames()
    require_distinct(policies)
    unfit = {spec.label: world.why_not_applicable(spec) for spec in policies}
    draws = choose_draws(hardware, options.draws)
    fit = [spec for spec in policies if unfit[spec.label] is None]
    total = len(fit) * (1 + len(draws))
    each = _per_draw(options, draws)
    with started(world, options.workers, total) as run_jobs:
        means, drawn = _run(fit, draws, each, _counted(run_jobs, total, progress))
    results = tuple(_result(spec, unfit[spec.label], means, drawn) for spec in policies)
    scored = [result for result in results if result.status == "ok"]
    pools = {item.label: pool_of(means[item.label], drawn[item.label]) for item in scored}
    logs = {label: log for label in pools if (log := means[label].log) is not None}
    comparison = Comparison(
        scene=scene.name,
        trace=trace.name,
        hardware=hardware.name,
        budget_ms=replay_options.budget_ms,
        seed=replay_options.seed,
        frames=max(map(len, logs.values()), default=0),
        warmup=options.warmup,
        conditions=_conditions(world),
        intervals=Intervals(LEVEL, each * max(len(draws), 1), BLOCKS, len(draws)),
        policies=results,
        pareto=find_front([item for item in scored if not item.oracle], pools),
        beats=beats(pools),
    )
    return comparison, logs


def choose_draws(hardware: HardwareProfile, count: int) -> list[int]:
    """Return evenly spaced posterior draws, each once."""
    available = 0 if hardware.posterior is None else len(hardware.posterior)
    chosen = np.linspace(0, available - 1, min(count, available)).round()
    return [int(draw) for draw in chosen]


def _per_draw(options: CompareOptions, draws: list[int]) -> int:
    return -(-options.resamples // max(len(draws), 1))


def _counted(run_jobs: RunJobs, total: int, progress: Progress | None) -> RunJobs:
    """Return `run_jobs`, telling of each finished job."""
    if progress is None:
        return run_jobs
    done = itertools.count(1)

    def run(jobs: Sequence[Job]) -> Iterator[Scored]:
        for scored in run_jobs(jobs):
            progress(next(done), total)
            yield scored

    return run


def _run(
    specs: list[PolicySpec], draws: list[int], each: int, run_jobs: RunJobs
) -> tuple[dict[str, Scored], dict[str, list[Scored]]]:
    """Score every policy under the mean, then those that did not fail under every draw."""
    jobs = [Job(spec, None, 0, 0 if draws else each) for spec in specs]
    means = {spec.label: scored for spec, scored in zip(specs, run_jobs(jobs), strict=True)}
    sound = [spec for spec in specs if means[spec.label].failure is None]
    jobs = [Job(spec, draw, stream, each) for spec in sound for stream, draw in enumerate(draws)]
    scored = iter(list(run_jobs(jobs)))
    return means, {spec.label: [next(scored) for _ in draws] for spec in sound}


def _result(
    spec: PolicySpec,
    unfit: str | None,
    means: dict[str, Scored],
    drawn: dict[str, list[Scored]],
) -> PolicyResult:
    oracle = spec.make().capabilities.future
    runs = [means[spec.label], *drawn.get(spec.label, [])] if unfit is None else []
    failure = next((run.failure for run in runs if run.failure is not None), None)
    if unfit is not None or failure is not None:
        status = "failed" if unfit is None else "not-applicable"
        reason = failure if unfit is None else unfit
        return PolicyResult(spec.name, spec.label, spec.params, status, reason, oracle, 0, {})
    mean = runs[0]
    pool: Pool = pool_of(mean, drawn[spec.label])
    metrics: dict[str, Score] = {}
    for metric in METRICS:
        low, high = interval(pool.get(metric.id))
        value = mean.values[metric.id]
        metrics[metric.id] = Score(value, low, high, metric.unit, metric.better)
    frames = 0 if mean.log is None else len(mean.log)
    return PolicyResult(
        spec.name, spec.label, spec.params, "ok", None, oracle, frames, metrics, mean.steps
    )


def _conditions(world: World) -> ReplayConditions:
    display, options = world.hardware.display, world.options
    return ReplayConditions(
        display=display.mode,
        refresh_hz=display.refresh_hz,
        frames_in_flight=world.hardware.frames_in_flight,
        width_px=display.width_px,
        height_px=display.height_px,
        fovy_deg=options.fovy_deg,
        crossfade_ms=options.crossfade_ms,
        measurement_delay=options.measurement_delay,
        trace_s=world.trace.duration_s,
        nodes=len(world.scene),
        hardware_source=world.hardware.provenance.source,
        hardware_assumed=world.hardware.provenance.assumed,
    )
