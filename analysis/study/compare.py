"""Compare policies: replay each in the same world and score all on the same footing."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...base.errors import require_whole
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec, is_oracle
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.metric_registry import METRICS
from ..verdict.bootstrap import BLOCKS
from ..verdict.pareto import find_front
from ..verdict.uncertainty import LEVEL, Pool, beats, interval, pool_of
from .comparison import Comparison, Intervals, PolicyResult, ReplayConditions, Score
from .engine.limits import DEFAULT_LIMITS, Limits
from .engine.open_engine import open_engine
from .runs import Progress, Runs, carry_out, choose_draws, plan_runs
from .score import World

if TYPE_CHECKING:
    from .comparison_target import ComparisonTarget


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
    policy_limits : Limits
        What a policy may take.
    scheduler : str or None
        Address of a Dask scheduler in place of processes here.
    """

    warmup: int = 30
    resamples: int = 200
    draws: int = 16
    workers: int = 0
    policy_limits: Limits = DEFAULT_LIMITS
    scheduler: str | None = None

    def __post_init__(self) -> None:
        for name, low in (("warmup", 0), ("resamples", 1), ("draws", 0), ("workers", 0)):
            require_whole(getattr(self, name), name, low)


def compare(
    policies: Sequence[PolicySpec],
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    replay_options: ReplayOptions,
    options: CompareOptions | None = None,
    *,
    progress: Progress | None = None,
    target: "ComparisonTarget | None" = None,
) -> tuple[Comparison, dict[str, FrameLog]]:
    """Replay and score policies; return the comparison, and each frame log by label.

    A policy that breaks its contract is reported as failed, and the others are finished.

    Parameters
    ----------
    target
        Where the comparison is to be written.  Runs are kept beside it as they are done; if it
        holds this very comparison, that is returned.

    Raises `InputError` if a policy is given twice, its parameters are refused, or all frames would
    be warm-up.
    """
    options = options or CompareOptions()
    world = World(scene, trace, hardware, replay_options, options.warmup)
    draws = choose_draws(hardware, options.draws)
    each = -(-options.resamples // max(len(draws), 1))
    resamples = (0 if draws else each, each)
    plan = plan_runs(policies, world, [replay_options.seed], draws, resamples)
    limits = options.policy_limits
    if target is not None and (earlier := target.begin(plan, limits)) is not None:
        return earlier
    engine = open_engine(
        plan.inputs, workers=options.workers, limits=limits, scheduler=options.scheduler
    )
    runs = carry_out(plan, engine, progress, None if target is None else target.work)
    pools = {
        label: pool_of(run.means[0], [drawn for (drawn,) in run.drawn])
        for label, run in runs.items()
        if run.failure is None
    }
    results = tuple(_result(spec, runs[spec.label], pools) for spec in policies)
    scored = [result for result in results if result.status == "ok"]
    logs = {label: log for label in pools if (log := runs[label].means[0].log) is not None}
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


def _result(spec: PolicySpec, runs: Runs, pools: dict[str, Pool]) -> PolicyResult:
    named = (spec.name, spec.label, spec.params)
    if runs.failure is not None:
        oracle = is_oracle(spec)
        return PolicyResult(*named, runs.failure.kind, str(runs.failure), oracle, 0, {})
    (mean,) = runs.means
    metrics: dict[str, Score] = {}
    for metric in METRICS:
        low, high = interval(pools[spec.label].get(metric.id))
        metrics[metric.id] = Score(mean.values[metric.id], low, high, metric.unit, metric.better)
    oracle = mean.log is not None and mean.log.header.oracle
    return PolicyResult(*named, "ok", None, oracle, mean.frames, metrics, mean.steps)


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
