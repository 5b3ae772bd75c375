"""Runs that are never replayed, and results made up for them."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.analysis.metrics.footing import Footing
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.metrics.steps import Step
from lodbench.analysis.metrics.worst_moment import Moment
from lodbench.analysis.study.engine.task import Failure, Outcome
from lodbench.analysis.study.results.run_list import RunList
from lodbench.analysis.study.run import Run
from lodbench.analysis.study.score import Scored
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions

NAMES = {"a1": "plaza", "b2": "tour", "c3": "desktop"}
IDS = [metric.id for metric in METRICS]


def build_runs(
    count: int, policies: tuple[str, ...] = ("full",), *, keeps_log: bool = False, **more: Any
) -> RunList:
    """List runs of each policy under so many seeds, of inputs that nobody has."""
    runs = [
        Run(
            parse_policy(label),
            "a1",
            "b2",
            "c3",
            ReplayOptions(budget_ms=8.0, seed=seed),
            warmup_s=2.0,
            keeps_log=keeps_log,
        )
        for label in policies
        for seed in range(count)
    ]
    return RunList(tuple(runs), NAMES, **more)


def build_scored(seed: int, **more: Any) -> Scored:
    """Make up scores: each metric a number of its own, some without any."""
    rng = np.random.default_rng(seed)
    values = {name: None if rng.random() < 0.2 else float(rng.normal()) for name in IDS}
    steps = (Step(seed, 1.5, 2.0, 3.0, 0.1, bool(seed % 2), 1.25),) * (seed % 3)
    worst = Moment("tour", 2.0, (0.0, 0.0, 1.7), 9.0, 5.0, "triangles", 3.0)
    scored = Scored(
        None,
        values,
        steps,
        30 + seed,
        float(rng.random()),
        worst,
        Footing(90.0, 0.1),
        {"more": 4.0 + seed},
    )
    return replace(scored, **more)


def build_outcome(at: int, **more: Any) -> Outcome:
    """Make up what became of a run; every seventh fails."""
    if at % 7 == 6:
        return Outcome(at, None, Failure("failed", f"no. {at}", at))
    return Outcome(at, build_scored(at, **more))


@pytest.fixture(scope="session")
def make_runs() -> Callable[..., RunList]:
    """Return `build_runs`."""
    return build_runs


@pytest.fixture(scope="session")
def make_scored() -> Callable[..., Scored]:
    """Return `build_scored`."""
    return build_scored


@pytest.fixture(scope="session")
def make_outcome() -> Callable[..., Outcome]:
    """Return `build_outcome`."""
    return build_outcome
