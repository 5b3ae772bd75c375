"""What a gate judges: every metric of a policy with its interval, over several seeds.

Seeds are the same in the baseline, and resample r is of the same windows of the camera's path in
both, so that what the two runs share does not blur their difference (common random numbers; Law,
Simulation Modeling and Analysis, chapter 11).
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...policies.policy_spec import PolicySpec
from ...policies.registry import require_distinct
from ...sim.frame_log import FrameLog
from ..metrics.measured_frames import Run
from ..metrics.metric_registry import METRICS
from ..study.compare import choose_draws
from ..study.comparison import PolicyResult, Score
from ..study.comparison_folder import read_results
from ..study.score import Job, Scored, World, resample
from ..study.workers import RunJobs, started
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
    """

    seeds: int = 4  # enough to find 5 % more in the 99th percentile of 200 frames; see docs/ci.md
    resamples: int = 200
    draws: int = 16
    workers: int = 1

    def __post_init__(self) -> None:
        for name, low in (("seeds", 1), ("resamples", 10), ("draws", 0), ("workers", 0)):
            value = getattr(self, name)
            if value < low:
                raise InputError(f"{name}: expected a whole number >= {low}, got {value}")


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


def measure(
    policies: Sequence[PolicySpec], world: World, sampling: MeasureOptions
) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Replay each policy under successive seeds, from the one of the world's options on.

    Raises `InputError` if a policy is given twice, its parameters are refused, or all frames would
    be warm-up.
    """
    world.require_scored_frames()
    require_distinct(policies)
    unfit = {spec.label: world.why_not_applicable(spec) for spec in policies}
    fit = [spec for spec in policies if unfit[spec.label] is None]
    with started(world, sampling.workers, len(fit) * sampling.seeds) as run_jobs:
        scored = _run(fit, world, sampling, run_jobs)
    options, names = world.options, (world.scene.name, world.trace.name)
    measured: list[MeasuredPolicy] = []
    for label, reason in unfit.items():
        if reason is not None:
            measured.append(MeasuredPolicy(label, *names, f"not applicable: {reason}"))
        else:
            measured.append(_measured(label, names, *scored[label]))
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


def _run(
    specs: list[PolicySpec], world: World, sampling: MeasureOptions, run_jobs: RunJobs
) -> dict[str, tuple[list[Scored], list[list[Scored]]]]:
    """Score each policy by seed under the mean, and by draw and seed."""
    seeds = range(world.options.seed, world.options.seed + sampling.seeds)
    draws = choose_draws(world.hardware, sampling.draws)
    each = -(-sampling.resamples // max(len(draws), 1))
    jobs = [Job(spec, None, 0, sampling.resamples, seed) for spec in specs for seed in seeds]
    means = iter(run_jobs(jobs))
    by_seed = {spec.label: [next(means) for _ in seeds] for spec in specs}
    sound = [spec for spec in specs if all(run.failure is None for run in by_seed[spec.label])]
    jobs = [
        Job(spec, draw, stream, each, seed)
        for spec in sound
        for stream, draw in enumerate(draws)
        for seed in seeds
    ]
    drawn = iter(run_jobs(jobs))
    by_draw = {spec.label: [[next(drawn) for _ in seeds] for _ in draws] for spec in sound}
    return {label: (runs, by_draw.get(label, [])) for label, runs in by_seed.items()}


def _measured(
    label: str, names: tuple[str, str], means: list[Scored], drawn: list[list[Scored]]
) -> MeasuredPolicy:
    for run in (*means, *(run for runs in drawn for run in runs)):
        if run.failure is not None:
            return MeasuredPolicy(label, *names, run.failure, failed=True)
    paired = _pool(means)
    pools = [_pool(runs) for runs in drawn] or [paired]
    scores: dict[str, Score] = {}
    for metric in METRICS:
        known = [value for run in means if (value := run.values[metric.id]) is not None]
        value = float(np.mean(known)) if known else None
        every = [pool[metric.id] for pool in pools if metric.id in pool]
        low, high = interval(np.concatenate(every) if len(every) == len(pools) else None)
        scores[metric.id] = Score(value, low, high, metric.unit, metric.better)
    logs = tuple(run.log for run in means if run.log is not None)
    return MeasuredPolicy(label, *names, None, False, scores, paired, logs)


def _pool(runs: list[Scored]) -> Pool:
    """Return resampled means over seeds, by metric."""
    pool: Pool = {}
    for metric in METRICS:
        arrays = [run.resampled[metric.id] for run in runs if metric.id in run.resampled]
        known = [value for run in runs if (value := run.values[metric.id]) is not None]
        if len(arrays) == len(runs):
            pool[metric.id] = _mean(np.array(arrays))
        elif len(known) == len(runs) > 1:
            pool[metric.id] = _mean_over_seeds(np.array(known), _count(runs))
    return pool


def _count(runs: Iterable[Scored]) -> int:
    return max(len(array) for run in runs for array in run.resampled.values())


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
    names = (comparison.scene, comparison.trace)
    count = comparison.intervals.resamples
    measured: list[MeasuredPolicy] = []
    for policy in comparison.policies:
        log = logs.get(policy.label)
        if log is None:
            measured.append(_without_scores(policy, names))
            continue
        run = Run(log, comparison.warmup)
        statistics = {metric.id: metric(run) for metric in METRICS}
        paired = resample(run, statistics, comparison.seed, 0, count)
        measured.append(
            MeasuredPolicy(policy.label, *names, None, False, policy.metrics, paired, (log,))
        )
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


def _without_scores(policy: PolicyResult, names: tuple[str, str]) -> MeasuredPolicy:
    failed = policy.status == "failed"
    reason = policy.reason if failed else f"not applicable: {policy.reason}"
    return MeasuredPolicy(policy.label, *names, reason, failed)
