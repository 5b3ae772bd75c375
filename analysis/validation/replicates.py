"""Simulate recordings of one path: as many as tell where one more of them would lie.

A replicate has a draw of the machine and a seed of the noise, which all policies share; the path is
that of the recordings.  So what replicates differ by is what two recordings may differ by: the
machine's state and noise, and what nobody knows of its costs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...base.errors import InputError
from ...models.machine.hardware import HardwareProfile
from ...models.scene.scene import Scene
from ...policies.registry import parse_policy
from ...sim.frame_log import FrameLog
from ...sim.replay import ReplayOptions
from ...traces.cameras.camera_trace import CameraTrace
from ..study.compare import CompareSettings
from ..study.engine.open_engine import open_engine
from ..study.replays import Place, Replays, make_bench
from ..study.runs import Progress, choose_draws
from ..study.score import MISS, Scored

REPLICATES = 40
"""Of each policy: with so many both ends of a 90 % interval lie two from the extremes."""

_LEAST, _MOST = 19, 10_000  # with 19 its ends are the extremes

FULL = "full"


@dataclass(frozen=True, slots=True, eq=False)
class Simulated:
    """One policy's simulated replays.

    Attributes
    ----------
    mean : Scored
        Under the profile's mean, with its frame log.
    replicates : tuple of Scored
        Each under a draw of the machine and a seed of its own.
    """

    mean: Scored
    replicates: tuple[Scored, ...]

    @property
    def log(self) -> FrameLog:
        """Frames under the mean."""
        assert self.mean.log is not None, "it is asked for with its log"
        return self.mean.log

    def values(self, metric: str) -> FloatArray:
        """Return a metric in each replicate, (R,); NaN where it has none."""
        found = [run.values[metric] for run in self.replicates]
        return np.array(found, dtype=np.float64)


@dataclass(frozen=True, slots=True, eq=False)
class Simulation:
    """What was simulated on one path, and by what it is scored.

    Attributes
    ----------
    window_s : (from, to)
        Seconds of the path that count.
    policies : dict of str to Simulated
        By label.
    failed : dict of str to str
        Why policies could not be simulated, by label.
    full : FrameLog or None
        Full detail along the path; None where it does not fit the scene.
    draws : int
        Different draws of the machine among the replicates.
    """

    scene: str
    trace: str
    trace_s: float
    budget_ms: float
    seed: int
    window_s: tuple[float, float]
    policies: Mapping[str, Simulated]
    failed: Mapping[str, str]
    full: FrameLog | None
    draws: int
    miss: float = MISS


def require_replicates(count: int) -> None:
    """Raise `InputError` if there are too few replicates for an interval of 90 %."""
    if not _LEAST <= count <= _MOST:
        raise InputError(
            f"--replicates: expected {_LEAST} to {_MOST}, got {count}; with fewer there is no "
            "interval that holds nine in ten"
        )


def replicate_places(label: str, draws: Sequence[int], seed: int, count: int) -> list[Place]:
    """Return the replays of one policy: the draws in turn, a seed each, none that of the mean."""
    drawn = [draws[at % len(draws)] if draws else None for at in range(count)]
    return [Place(label, 0, seed + 1 + at, draw=draw) for at, draw in enumerate(drawn)]


def simulate_all(
    labels: Sequence[str],
    scene: Scene,
    trace: CameraTrace,
    hardware: HardwareProfile,
    options: ReplayOptions,
    settings: CompareSettings,
    replicates: int = REPLICATES,
    progress: Progress | None = None,
) -> Simulation:
    """Simulate policies along a path, each as it is typed, under the mean and many times more."""
    every = list(dict.fromkeys((*labels, FULL)))
    bench = make_bench(
        [parse_policy(label) for label in every],
        scene,
        [trace],
        hardware,
        options,
        settings.warmup_s,
        miss=settings.miss,
    )
    limits = settings.policy_limits
    engine = open_engine(
        bench.inputs, workers=settings.workers, limits=limits, scheduler=settings.scheduler
    )
    draws = choose_draws(hardware, replicates)
    mean = {label: Place(label, 0, options.seed, logged=True) for label in every}
    drawn = {label: replicate_places(label, draws, options.seed, replicates) for label in labels}
    with engine:
        replays = Replays(bench, engine, progress, limits=limits)
        replays.make([*mean.values(), *(place for label in labels for place in drawn[label])])
    return Simulation(
        scene=scene.name,
        trace=trace.name,
        trace_s=trace.duration_s,
        budget_ms=options.budget_ms,
        seed=options.seed,
        window_s=(settings.warmup_s, trace.duration_s),
        policies={
            label: Simulated(replays[mean[label]], tuple(replays[at] for at in drawn[label]))
            for label in labels
            if label not in replays.failures
        },
        failed={
            label: str(failure) for label, failure in replays.failures.items() if label in labels
        },
        full=None if FULL in replays.failures else replays[mean[FULL]].log,
        draws=len(set(draws)),
        miss=settings.miss,
    )
