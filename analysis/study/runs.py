"""The replays of policies in one world: over seeds, and over draws of the cost model."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ...base.content_hash import content_hash
from ...models.machine.hardware import HardwareProfile
from ...policies.policy_spec import PolicySpec
from ...policies.registry import require_distinct
from .engine.limits import Limits
from .engine.open_engine import open_engine
from .engine.task import Engine, Failure
from .run import Run
from .score import Scored, World

Progress = Callable[[int, int], None]
"""Called with the replays done and the replays in all."""


@dataclass(frozen=True, slots=True)
class Plan:
    """The runs of policies in one world.

    Attributes
    ----------
    inputs : dict of str to object
        What they share, by content hash.
    runs : tuple of Run
        By policy, then by draw, the mean first, then by seed.
    """

    inputs: Mapping[str, Any]
    runs: tuple[Run, ...]


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
    workers: int,
    progress: Progress | None = None,
    *,
    limits: Limits | None = None,
    scheduler: str | None = None,
) -> dict[str, Runs]:
    """Replay every policy, and return what became of each, by label (see `plan_runs`).

    Raises `InputError` as `plan_runs`, or if the parameters of a policy are refused.

    Parameters
    ----------
    workers, limits, scheduler
        Of the engine (see `open_engine`).
    """
    plan = plan_runs(policies, world, seeds, draws)
    engine = open_engine(plan.inputs, workers=workers, limits=limits, scheduler=scheduler)
    return carry_out(plan, engine, progress)


def plan_runs(
    policies: Sequence[PolicySpec],
    world: World,
    seeds: Sequence[int],
    draws: Sequence[int],
) -> Plan:
    """List the replays of every policy.

    Raises `InputError` if a policy is given twice, or all of the path would be warm-up.
    """
    world.require_window()
    require_distinct(policies)
    inputs = {content_hash(value): value for value in (world.scene, world.trace, world.hardware)}
    scene, trace, hardware = inputs
    runs = tuple(
        Run(
            policy,
            scene,
            trace,
            hardware,
            replace(world.options, draw=draw, seed=seed),
            world.warmup_s,
            keeps_log=draw is None,
        )
        for policy in policies
        for draw in (None, *draws)
        for seed in seeds
    )
    return Plan(inputs, runs)


def carry_out(plan: Plan, engine: Engine, progress: Progress | None = None) -> dict[str, Runs]:
    """Carry out runs, and return what became of each policy, by label.

    Raises `InputError` if the parameters of a policy are refused.
    """
    results: dict[int, Scored | Failure] = {}
    with engine:
        for outcome in engine.run(plan.runs):
            results[outcome.index] = outcome.failure or outcome.result
            if progress is not None:
                progress(len(results), len(plan.runs))
    return _by_policy(plan.runs, results)


def _by_policy(runs: Sequence[Run], results: Mapping[int, Scored | Failure]) -> dict[str, Runs]:
    """Return results in the order of their runs, whatever the order in which they were finished."""
    found = {run.owner: Runs() for run in runs}
    drawn: dict[tuple[str, int], list[Scored]] = {}
    for at, run in enumerate(runs):
        result, mine = results.get(at), found[run.owner]
        if isinstance(result, Failure):
            mine.failure = mine.failure or _with_draw(result, run.options.draw)
        elif result is not None and run.options.draw is None:
            mine.means.append(result)
        elif result is not None and run.options.draw is not None:
            key = run.owner, run.options.draw
            if key not in drawn:
                drawn[key] = []
                mine.drawn.append(drawn[key])
            drawn[key].append(result)
    return found


def _with_draw(failure: Failure, draw: int | None) -> Failure:
    if draw is None or failure.kind == "not-applicable":
        return failure
    return replace(failure, reason=f"under posterior draw {draw}, {failure.reason}")
