"""What a gate judges: every metric of a policy with its interval, over several seeds.

Seeds are the same in the baseline, and resample r is of the same windows of the camera's path in
both, so that what the two runs share does not blur their difference (common random numbers; Law,
Simulation Modeling and Analysis, chapter 11).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import require_whole
from ...policies.policy_spec import PolicySpec
from ...sim.frame_log import FrameLog
from ..metrics.measured_frames import MeasuredFrames
from ..metrics.metric_registry import METRICS
from ..study.comparison import Score
from ..study.comparison_folder import read_results
from ..study.engine.limits import DEFAULT_LIMITS, Limits
from ..study.runs import Progress, Runs, choose_draws, run_policies
from ..study.score import Scored, World, resample
from ..verdict.uncertainty import Pool, interval


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureOptions:
    """How much is replayed.

    Attributes
    ----------
    seeds : int
        Replays of each policy, with successive seeds.
    resamples : int
        Bootstrap resamples.
    draws : int
        Posterior draws of the cost model to replay under each seed, if the profile has them.
    workers : int
        Processes; 0 for as many as there are processors.  Results do not depend on it.
    policy_limits : Limits
        What a policy may take.
    scheduler : str or None
        Address of a Dask scheduler in place of processes here.
    """

    seeds: int = 4  # enough to find 5 % more in the 99th percentile of 200 frames; see docs/ci.md
    resamples: int = 200
    draws: int = 16
    workers: int = 1
    policy_limits: Limits = DEFAULT_LIMITS
    scheduler: str | None = None

    def __post_init__(self) -> None:
        for name, low in (("seeds", 1), ("resamples", 10), ("draws", 0), ("workers", 0)):
            require_whole(getattr(self, name), name, low)


@dataclass(frozen=True, slots=True)
class Conditions:
    """What has to be the same in two measurements for one to be the baseline of the other."""

    hardware: str
    budget_ms: float
    refresh_hz: float
    seed: int
    seeds: int
    resamples: int
    warmup: int
    frames: int | None


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPolicy:
    """One policy in one scene on one trace.

    Attributes
    ----------
    reason : str or None
        Why there are no scores.
    failed : bool
        Whether that is because the policy broke its contract, not because it does not apply.
    scores : dict of str to Score
        Mean over seeds, and the interval over resamples and draws of the cost model.
    paired : dict of str to (R,) float64
        Resampled means over seeds under the profile's own cost model, to be compared with the same
        of a baseline.
    logs : tuple of FrameLog
        One a seed.
    """

    policy: str
    scene: str
    trace: str
    reason: str | None = None
    failed: bool = False
    scores: dict[str, Score] = field(default_factory=dict[str, Score])
    paired: Pool = field(default_factory=dict[str, FloatArray])
    logs: tuple[FrameLog, ...] = ()

    @property
    def case(self) -> tuple[str, str, str]:
        """Policy, scene and trace."""
        return self.policy, self.scene, self.trace


def measure(
    policies: Sequence[PolicySpec],
    world: World,
    sampling: MeasureOptions,
    progress: Progress | None = None,
) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Replay each policy under successive seeds, from the one of the world's options on.

    Raises `InputError` if a policy is given twice, its parameters are refused, or all frames would
    be warm-up.
    """
    options = world.options
    seeds = range(options.seed, options.seed + sampling.seeds)
    draws = choose_draws(world.hardware, sampling.draws)
    resamples = (sampling.resamples, -(-sampling.resamples // max(len(draws), 1)))
    runs = run_policies(
        policies,
        world,
        seeds,
        draws,
        resamples,
        sampling.workers,
        progress,
        limits=sampling.policy_limits,
        scheduler=sampling.scheduler,
    )
    names = (world.scene.name, world.trace.name)
    measured = [_measured((label, *names), run) for label, run in runs.items()]
    conditions = Conditions(
        world.hardware.name,
        options.budget_ms,
        world.hardware.display.refresh_hz,
        options.seed,
        sampling.seeds,
        sampling.resamples,
        world.warmup,
        options.frames,
    )
    return conditions, measured


def _measured(names: tuple[str, str, str], runs: Runs) -> MeasuredPolicy:
    if runs.failure is not None:
        failed = runs.failure.kind == "failed"
        reason = str(runs.failure) if failed else f"not applicable: {runs.failure}"
        return MeasuredPolicy(*names, reason, failed)
    means = runs.means
    paired = _pool(means)
    pools = [_pool(drawn) for drawn in runs.drawn] or [paired]
    scores: dict[str, Score] = {}
    for metric in METRICS:
        known = [value for run in means if (value := run.values[metric.id]) is not None]
        value = float(np.mean(known)) if known else None
        every = [pool[metric.id] for pool in pools if metric.id in pool]
        low, high = interval(np.concatenate(every) if len(every) == len(pools) else None)
        scores[metric.id] = Score(value, low, high, metric.unit, metric.better)
    logs = tuple(run.log for run in means if run.log is not None)
    return MeasuredPolicy(*names, None, False, scores, paired, logs)


def _pool(runs: list[Scored]) -> Pool:
    """Return resampled means over seeds, by metric."""
    pool: Pool = {}
    for metric in METRICS:
        arrays = [run.resampled[metric.id] for run in runs if metric.id in run.resampled]
        known = [value for run in runs if (value := run.values[metric.id]) is not None]
        if len(arrays) == len(runs):
            pool[metric.id] = _mean(np.array(arrays))
        elif len(known) == len(runs) > 1:
            count = max(len(array) for run in runs for array in run.resampled.values())
            pool[metric.id] = _mean_over_seeds(np.array(known), count)
    return pool


def _mean(values: FloatArray) -> FloatArray:
    """Return the mean of the rows, NaN aside; NaN where a column has nothing else."""
    count = np.count_nonzero(~np.isnan(values), axis=0)
    total = np.nansum(values, axis=0)
    return np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0)


def _mean_over_seeds(values: FloatArray, count: int) -> FloatArray:
    """Return resampled means of values of which a run has only one, such as its single step.

    Seeds are resampled, the same ones here and in the baseline; deviations are widened by
    sqrt(n / (n - 1)), since the bootstrap of n values has n - 1 in place of n in its variance.
    """
    n = len(values)
    chosen = np.random.default_rng(n).integers(0, n, (count, n))
    deviation = values[chosen].mean(axis=1) - values.mean()
    return values.mean() + deviation * np.sqrt(n / (n - 1))


def measure_run(folder: Path) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Return what a folder that `compare --out` wrote holds: one seed.

    Raises `InputError` if a file is missing, broken, or of another run.
    """
    comparison, logs = read_results(folder)
    count = comparison.intervals.resamples
    measured: list[MeasuredPolicy] = []
    for policy in comparison.policies:
        names = (policy.label, comparison.scene, comparison.trace)
        if policy.status != "ok":
            failed = policy.status == "failed"
            reason = policy.reason if failed else f"not applicable: {policy.reason}"
            measured.append(MeasuredPolicy(*names, reason, failed))
            continue
        run = MeasuredFrames(logs[policy.label], comparison.warmup)
        statistics = {metric.id: metric(run) for metric in METRICS}
        paired = resample(run, statistics, comparison.seed, 0, count)
        logged = (run.log,)
        measured.append(MeasuredPolicy(*names, None, False, policy.metrics, paired, logged))
    conditions = Conditions(
        comparison.hardware,
        comparison.budget_ms,
        comparison.conditions.refresh_hz,
        comparison.seed,
        1,
        count,
        comparison.warmup,
        None,
    )
    return conditions, measured
