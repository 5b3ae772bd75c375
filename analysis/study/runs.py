"""The replays of policies that a study asks for: over seeds, and over draws of the cost model."""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ...models.machine.hardware import HardwareProfile
from ...policies.policy_spec import PolicySpec
from ...policies.registry import require_distinct
from .score import Job, Scored, World
from .workers import started

Progress = Callable[[int, int], None]
"""Called with the replays done and the replays in all."""


@dataclass(frozen=True, slots=True)
class Runs:
    """What became of one policy.

    Attributes
    ----------
    unfit : str or None
        Why it does not apply to the scene; then nothing was replayed.
    means : list of Scored
        Under the profile's mean, one a seed.
    drawn : list of list of Scored
        By posterior draw, one a seed each; empty if a replay under the mean failed.
    """

    unfit: str | None
    means: list[Scored]
    drawn: list[list[Scored]]

    @property
    def failure(self) -> str | None:
        """The first reason why a replay failed, if any did."""
        runs = itertools.chain(self.means, *self.drawn)
        return next((run.failure for run in runs if run.failure is not None), None)


def choose_draws(hardware: HardwareProfile, count: int) -> list[int]:
    """Return evenly spaced posterior draws, each once."""
    available = 0 if hardware.posterior is None else len(hardware.posterior)
    chosen = np.linspace(0, available - 1, min(count, available)).round()
    return [int(draw) for draw in chosen]


def run_policies(
    policies: Sequence[PolicySpec],
    world: World,
    seeds: Sequence[int],
    draws: Sequence[int],
    resamples: tuple[int, int],
    workers: int,
    progress: Progress | None = None,
) -> dict[str, Runs]:
    """Replay every policy that fits the scene, and return what became of each, by label.

    Raises `InputError` if a policy is given twice, its parameters are refused, or all frames would
    be warm-up.

    Parameters
    ----------
    resamples
        Of a replay under the mean, and of one under a draw.
    """
    world.require_scored_frames()
    require_distinct(policies)
    unfit = {spec.label: world.why_not_applicable(spec) for spec in policies}
    fit = [spec for spec in policies if unfit[spec.label] is None]
    total = len(fit) * len(seeds) * (1 + len(draws))
    done = itertools.count(1)
    with started(world, workers, total) as run_jobs:

        def run(jobs: list[Job]) -> Iterator[Scored]:
            for scored in run_jobs(jobs):
                if progress is not None:
                    progress(next(done), total)
                yield scored

        mean = run([Job(spec, None, 0, resamples[0], seed) for spec in fit for seed in seeds])
        means = {spec.label: [next(mean) for _ in seeds] for spec in fit}
        sound = [spec for spec in fit if all(run.failure is None for run in means[spec.label])]
        each = itertools.product(sound, enumerate(draws), seeds)
        draw = run([Job(spec, at, stream, resamples[1], seed) for spec, (stream, at), seed in each])
        drawn = {spec.label: [[next(draw) for _ in seeds] for _ in draws] for spec in sound}
    return {
        label: Runs(reason, means.get(label, []), drawn.get(label, []))
        for label, reason in unfit.items()
    }
