"""What a gate judges: every metric of a policy, over several seeds of noise on this path.

Seeds are the same in the baseline, so that what the two runs share does not blur their difference
(common random numbers; Law, Simulation Modeling and Analysis, chapter 11).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...base.errors import require_whole
from ...policies.policy_spec import PolicySpec
from ...sim.frame_log import FrameLog
from ..metrics.metric_registry import METRICS
from ..study.comparison import Score
from ..study.comparison_folder import read_results
from ..study.engine.limits import DEFAULT_LIMITS, Limits
from ..study.inputs import WHOLE, Seconds
from ..study.runs import Progress, Runs, choose_draws, run_policies
from ..study.score import World

LEVEL = 0.9
"""Coverage of the intervals."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureOptions:
    """How much is replayed.

    Attributes
    ----------
    seeds : int
        Replays of each policy, with successive seeds.
    draws : int
        Posterior draws of the cost model to replay under each seed, if the profile has them.
    workers : int
        Processes; 0 for as many as there are processors.  Results do not depend on it.
    policy_limits : Limits
        What a policy may take.
    scheduler : str or None
        Address of a Dask scheduler in place of processes here.
    """

    seeds: int = 4
    draws: int = 16
    workers: int = 1
    policy_limits: Limits = DEFAULT_LIMITS
    scheduler: str | None = None

    def __post_init__(self) -> None:
        for name, low in (("seeds", 1), ("draws", 0), ("workers", 0)):
            require_whole(getattr(self, name), name, low)


@dataclass(frozen=True, slots=True)
class Conditions:
    """What has to be the same in two measurements for one to be the baseline of the other."""

    hardware: str
    budget_ms: float
    refresh_hz: float
    seed: int
    seeds: int
    warmup_s: float
    visible_px: float
    seconds: Seconds = WHOLE


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
        Mean over seeds, and its interval: over seeds, or over draws of the cost model where there
        are any; none where there is only one of either.
    by_seed : dict of str to list of float or None
        Values under the profile's own cost model, to be compared with the same of a baseline.
    logs : tuple of FrameLog
        One a seed.
    """

    policy: str
    scene: str
    trace: str
    reason: str | None = None
    failed: bool = False
    scores: dict[str, Score] = field(default_factory=dict[str, Score])
    by_seed: dict[str, list[float | None]] = field(default_factory=dict[str, list[float | None]])
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

    Raises `InputError` if a policy is given twice, its parameters are refused, or all of the path
    would be warm-up.
    """
    options = world.options
    seeds = range(options.seed, options.seed + sampling.seeds)
    draws = choose_draws(world.hardware, sampling.draws)
    runs = run_policies(
        policies,
        world,
        seeds,
        draws,
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
        world.warmup_s,
        options.visible_px,
    )
    return conditions, measured


def _measured(names: tuple[str, str, str], runs: Runs) -> MeasuredPolicy:
    if runs.failure is not None:
        failed = runs.failure.kind == "failed"
        reason = str(runs.failure) if failed else f"not applicable: {runs.failure}"
        return MeasuredPolicy(*names, reason, failed)
    scores: dict[str, Score] = {}
    by_seed: dict[str, list[float | None]] = {}
    for metric in METRICS:
        by_seed[metric.id] = [run.values[metric.id] for run in runs.means]
        known = [value for value in by_seed[metric.id] if value is not None]
        low, high = _over_draws(runs, metric.id) if runs.drawn else interval(known)
        value = float(np.mean(known)) if known else None
        scores[metric.id] = Score(value, low, high, metric.unit, metric.better)
    logs = tuple(run.log for run in runs.means if run.log is not None)
    return MeasuredPolicy(*names, None, False, scores, by_seed, logs)


def _over_draws(runs: Runs, metric: str) -> tuple[float | None, float | None]:
    """Return the ends that hold `LEVEL` of the draws' means over seeds."""
    rows = [[run.values[metric] for run in seeds] for seeds in runs.drawn]
    known = [[value for value in row if value is not None] for row in rows]
    if not all(known):
        return None, None
    ends = ((1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0)
    low, high = np.quantile([np.mean(row) for row in known], ends)
    return float(low), float(high)


def interval(values: Sequence[float]) -> tuple[float | None, float | None]:
    """Return Student's interval of the mean of replicates, None and None of fewer than two."""
    n = len(values)
    if n < 2:
        return None, None
    from scipy.stats import t

    middle, sd = float(np.mean(values)), float(np.std(values, ddof=1))
    half = float(t.ppf(0.5 + 0.5 * LEVEL, n - 1)) * sd / n**0.5
    return middle - half, middle + half


def measure_run(folder: Path) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Return what a folder that `compare --out` wrote holds: one seed.

    Raises `InputError` if a file is missing, broken, or of another run.
    """
    comparison, logs = read_results(folder)
    measured: list[MeasuredPolicy] = []
    for policy in comparison.policies:
        names = (policy.label, comparison.scene, comparison.trace)
        if policy.status != "ok":
            failed = policy.status == "failed"
            reason = policy.reason if failed else f"not applicable: {policy.reason}"
            measured.append(MeasuredPolicy(*names, reason, failed))
            continue
        by_seed = {name: [score.value] for name, score in policy.metrics.items()}
        logged = (logs[policy.label],)
        measured.append(MeasuredPolicy(*names, None, False, policy.metrics, by_seed, logged))
    conditions = Conditions(
        comparison.hardware,
        comparison.budget_ms,
        comparison.conditions.refresh_hz,
        comparison.seed,
        1,
        comparison.window_s[0],
        comparison.visible_px,
    )
    return conditions, measured
