"""Compare policies: replay each in the same world and score all on the same footing."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...base.errors import require_real, require_whole
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec, is_oracle
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..metrics.metric_registry import METRICS
from .comparison import Comparison, Intervals, PolicyResult, ReplayConditions, Score
from .engine.limits import DEFAULT_LIMITS, Limits
from .engine.open_engine import open_engine
from .runs import Progress, Runs, carry_out, choose_draws, plan_runs
from .score import World

if TYPE_CHECKING:
    from .comparison_target import ComparisonTarget


LEVEL = 0.9
"""Share of posterior draws between the low and high end of an interval."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CompareOptions:
    """How to score.

    Attributes
    ----------
    warmup_s : float
        Seconds at the start of the path that no metric counts.
    draws : int
        Posterior draws of the cost model to replay, if the profile has them.
    workers : int
        Processes; 0 for as many as there are processors.  Results do not depend on it.
    policy_limits : Limits
        What a policy may take.
    scheduler : str or None
        Address of a Dask scheduler in place of processes here.
    """

    warmup_s: float = 1.0
    draws: int = 16
    workers: int = 0
    policy_limits: Limits = DEFAULT_LIMITS
    scheduler: str | None = None

    def __post_init__(self) -> None:
        for name, low in (("draws", 0), ("workers", 0)):
            require_whole(getattr(self, name), name, low)
        require_real(self.warmup_s, "warmup_s")


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

    Raises `InputError` if a policy is given twice, its parameters are refused, or all of the path
    would be warm-up.
    """
    options = options or CompareOptions()
    world = World(scene, trace, hardware, replay_options, options.warmup_s)
    draws = choose_draws(hardware, options.draws)
    plan = plan_runs(policies, world, [replay_options.seed], draws)
    limits = options.policy_limits
    if target is not None and (earlier := target.begin(plan, limits)) is not None:
        return earlier
    engine = open_engine(
        plan.inputs, workers=options.workers, limits=limits, scheduler=options.scheduler
    )
    runs = carry_out(plan, engine, progress, None if target is None else target.work)
    results = tuple(_result(spec, runs[spec.label]) for spec in policies)
    logs = {
        result.label: log
        for result in results
        if result.status == "ok" and (log := runs[result.label].means[0].log) is not None
    }
    comparison = Comparison(
        scene=scene.name,
        trace=trace.name,
        hardware=hardware.name,
        budget_ms=replay_options.budget_ms,
        seed=replay_options.seed,
        window_s=(options.warmup_s, trace.duration_s),
        visible_px=replay_options.visible_px,
        conditions=_conditions(world),
        intervals=Intervals(LEVEL, len(draws)),
        policies=results,
    )
    return comparison, logs


def _result(spec: PolicySpec, runs: Runs) -> PolicyResult:
    named = (spec.name, spec.label, spec.params)
    if runs.failure is not None:
        oracle = is_oracle(spec)
        return PolicyResult(*named, runs.failure.kind, str(runs.failure), oracle, 0, {})
    (mean,) = runs.means
    metrics: dict[str, Score] = {}
    for metric in METRICS:
        low, high = _ends([drawn.values[metric.id] for (drawn,) in runs.drawn])
        metrics[metric.id] = Score(mean.values[metric.id], low, high, metric.unit, metric.better)
    oracle = mean.log is not None and mean.log.header.oracle
    return PolicyResult(*named, "ok", None, oracle, mean.frames, metrics, mean.steps)


def _ends(values: Sequence[float | None]) -> tuple[float | None, float | None]:
    """Return the ends that hold `LEVEL` of the draws' values, None where one has no value."""
    known = [value for value in values if value is not None]
    if not known or len(known) < len(values):
        return None, None
    low, high = np.quantile(known, ((1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0))
    return float(low), float(high)


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
