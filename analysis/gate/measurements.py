"""What a gate judges: every metric of a policy on each path, under each seed.

Paths, seeds and machine are those of the baseline, so that what the two runs share does not blur
their difference (common random numbers; Law, Simulation Modeling and Analysis, chapter 11).
Policies run as they are given, on the machine of the profile's mean.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import require_whole
from ...models.machine.hardware import HardwareProfile
from ...models.scene.rig import Eyes
from ...models.scene.scene import Scene
from ...policies.policy_spec import PolicySpec
from ...policies.registry import require_distinct
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.compare import require_paths
from ..study.engine.limits import DEFAULT_LIMITS, Limits
from ..study.engine.open_engine import open_engine
from ..study.replays import Place, Replays, make_bench
from ..study.runs import Progress
from ..study.score import Scored


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasureOptions:
    """How much is replayed.

    Attributes
    ----------
    seeds : int
        Replays of each policy on each path, with successive seeds.
    workers : int
        Processes; 0 for as many as there are processors.  Results do not depend on it.
    policy_limits : Limits
        What a policy may take.
    scheduler : str or None
        Address of a Dask scheduler in place of processes here.
    """

    seeds: int = 4
    workers: int = 1
    policy_limits: Limits = DEFAULT_LIMITS
    scheduler: str | None = None

    def __post_init__(self) -> None:
        for name, low in (("seeds", 1), ("workers", 0)):
            require_whole(getattr(self, name), name, low)


@dataclass(frozen=True, slots=True, kw_only=True)
class Conditions:
    """What has to be the same in two measurements for one to be the baseline of the other."""

    hardware: str
    display: str
    refresh_hz: float
    frames_in_flight: int
    pacing: str
    latency_limit: int
    budget_ms: float
    seed: int
    seeds: int
    warmup_s: float
    visible_px: float
    fovy_deg: float = 60.0
    crossfade_ms: float = 0.0
    measurement_delay: int = 0
    eyes: Eyes | None = None


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredPolicy:
    """One policy in one scene.

    Attributes
    ----------
    paths : tuple of str
        Names of the n paths.
    hashes : tuple of str
        Their contents.
    runs : tuple of tuple of Scored
        By path, then by seed; empty where there are no scores.
    reason : str or None
        Why there are none.
    failed : bool
        Whether that is because the policy broke its contract, not because it does not apply.
    """

    policy: str
    scene: str
    paths: tuple[str, ...]
    hashes: tuple[str, ...]
    runs: tuple[tuple[Scored, ...], ...] = ()
    reason: str | None = None
    failed: bool = False

    def values(self, metric: str) -> FloatArray:
        """Return a metric by path and seed, (n, S); nan where a run does not have it."""
        values = [[run.values[metric] for run in seeds] for seeds in self.runs]
        return np.array(values, dtype=np.float64)


def measure(
    policies: Sequence[PolicySpec],
    scene: Scene,
    paths: Sequence[CameraTrace],
    hardware: HardwareProfile,
    options: ReplayOptions,
    sampling: MeasureOptions,
    warmup_s: float,
    progress: Progress | None = None,
) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Replay each policy on each path under successive seeds, from the one of the options on.

    Raises `InputError` if a policy or path is given twice, parameters are refused, or all of a path
    would be warm-up.
    """
    require_distinct(policies)
    for policy in policies:
        policy.check_parameters()
    require_paths(paths, warmup_s)
    bench = make_bench(policies, scene, paths, hardware, options, warmup_s)
    seeds = range(options.seed, options.seed + sampling.seeds)
    engine = open_engine(
        bench.inputs,
        workers=sampling.workers,
        limits=sampling.policy_limits,
        scheduler=sampling.scheduler,
    )
    with engine:
        replays = Replays(bench, engine, progress, None, sampling.policy_limits)
        replays.make(
            Place(spec.label, path, seed)
            for spec in policies
            for path in range(len(paths))
            for seed in seeds
        )
    names = tuple(path.name for path in paths)
    measured = [
        _measured(spec.label, scene.name, names, bench.paths, replays, seeds) for spec in policies
    ]
    return conditions_of(hardware, options, sampling.seeds, warmup_s), measured


def conditions_of(
    hardware: HardwareProfile, options: ReplayOptions, seeds: int, warmup_s: float
) -> Conditions:
    """Return what a baseline of such a measurement has to share with it."""
    return Conditions(
        hardware=hardware.name,
        display=hardware.display.mode,
        refresh_hz=hardware.display.refresh_hz,
        frames_in_flight=hardware.frames_in_flight,
        pacing=hardware.display.pacing,
        latency_limit=hardware.display.latency_limit,
        budget_ms=options.budget_ms,
        seed=options.seed,
        seeds=seeds,
        warmup_s=warmup_s,
        visible_px=options.visible_px,
        fovy_deg=options.fovy_deg,
        crossfade_ms=options.crossfade_ms,
        measurement_delay=options.measurement_delay,
        eyes=options.eyes,
    )


def _measured(
    label: str,
    scene: str,
    names: tuple[str, ...],
    hashes: tuple[str, ...],
    replays: Replays,
    seeds: Sequence[int],
) -> MeasuredPolicy:
    failure = replays.failures.get(label)
    if failure is not None:
        failed = failure.kind == "failed"
        reason = str(failure) if failed else f"not applicable: {failure}"
        return MeasuredPolicy(label, scene, names, hashes, (), reason, failed)
    runs = tuple(
        tuple(replays[Place(label, path, seed)] for seed in seeds) for path in range(len(names))
    )
    return MeasuredPolicy(label, scene, names, hashes, runs)
