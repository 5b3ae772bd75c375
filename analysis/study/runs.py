"""The replays of policies in one world: over seeds, and over draws of the cost model."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...base.content_hash import content_hash
from ...models.machine.hardware import HardwareProfile
from ...policies.policy_spec import PolicySpec
from ...policies.registry import require_distinct
from .engine.limits import Limits
from .engine.open_engine import open_engine
from .engine.task import Failure
from .run import Run
from .score import Scored, World

Progress = Callable[[int, int], None]
"""Called with the replays done and the replays in all."""


@dataclass(slots=True)
class Runs:
    """What became of one policy.

    Attributes
    ----------
    failure : Failure or None
        The first in the order of the runs.
    means : list of Scored
        Under the profile's mean, one a seed.
    drawn : list of list of Scored
        By posterior draw, one a seed each.
    """

    failure: Failure | None = None
    means: list[Scored] = field(default_factory=list[Scored])
    drawn: list[list[Scored]] = field(default_factory=list[list[Scored]])


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
    *,
    limits: Limits | None = None,
    scheduler: str | None = None,
) -> dict[str, Runs]:
    """Replay every policy, and return what became of each, by label.

    Raises `InputError` if a policy is given twice, its parameters are refused, or all frames would
    be warm-up.

    Parameters
    ----------
    resamples
        Of a replay under the mean, and of one under a draw.
    workers, limits, scheduler
        Of the engine (see `open_engine`).
    """
    world.require_scored_frames()
    require_distinct(policies)
    inputs = {content_hash(value): value for value in (world.scene, world.trace, world.hardware)}
    scene, trace, hardware = inputs
    plans = [(None, 0, resamples[0]), *((draw, at, resamples[1]) for at, draw in enumerate(draws))]
    runs = [
        Run(
            policy,
            scene,
            trace,
            hardware,
            replace(world.options, draw=draw, seed=seed),
            world.warmup,
            stream,
            count,
            keeps_log=draw is None,
        )
        for policy in policies
        for draw, stream, count in plans
        for seed in seeds
    ]
    scored: dict[int, Scored] = {}
    failed: dict[int, Failure] = {}
    with open_engine(inputs, workers=workers, limits=limits, scheduler=scheduler) as engine:
        for done, outcome in enumerate(engine.run(runs), 1):
            if outcome.failure is None:
                scored[outcome.index] = outcome.result
            else:
                failed[outcome.index] = outcome.failure
            if progress is not None:
                progress(done, len(runs))
    return _by_policy(policies, runs, scored, failed)


def _by_policy(
    policies: Sequence[PolicySpec],
    runs: Sequence[Run],
    scored: dict[int, Scored],
    failed: dict[int, Failure],
) -> dict[str, Runs]:
    """Return runs in their order, whatever the order in which they were finished."""
    found = {policy.label: Runs() for policy in policies}
    for index in sorted(scored):
        run, mine = runs[index], found[runs[index].owner]
        if run.options.draw is None:
            mine.means.append(scored[index])
        else:
            while len(mine.drawn) <= run.stream:
                mine.drawn.append([])
            mine.drawn[run.stream].append(scored[index])
    for index in sorted(failed, reverse=True):
        found[runs[index].owner].failure = _with_draw(failed[index], runs[index].options.draw)
    return found


def _with_draw(failure: Failure, draw: int | None) -> Failure:
    if draw is None or failure.kind == "not-applicable":
        return failure
    return replace(failure, reason=f"under posterior draw {draw}, {failure.reason}")
