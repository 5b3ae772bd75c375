"""Bring every policy to its operating point: the finest knob that surely keeps the budget.

Policies that were left at somebody's defaults spend different shares of the budget, and what is
compared then is the defaults.  Each policy is tuned on some paths and judged on others, by
rotation, so that no path helps to choose the knob that it judges.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...base.arrays import FloatArray
from ...policies.knob import Knob
from ..verdict.folds import folds
from ..verdict.operating_point import OperatingPoint, next_knob, operating_point
from .replays import Place, Replays

FIRST_VALUES = 6
"""Values of a knob that are replayed before anything is known, its ends among them."""
MOST_VALUES = 14
"""Values of a knob that are replayed at most."""


@dataclass(frozen=True, slots=True, eq=False)
class Tuned:
    """A policy's knob, replayed and chosen.

    Attributes
    ----------
    values : (K,) float64
        What was replayed, from coarse to fine.
    point : OperatingPoint
        From all training paths: what is recommended.
    judged : (n,) float64
        At which value each of the n judged paths is judged.
    """

    values: FloatArray
    point: OperatingPoint
    judged: FloatArray


@dataclass(frozen=True, slots=True)
class Rotation:
    """Which paths knobs are tuned on, and which they are judged on.

    Attributes
    ----------
    training : tuple of int
        Positions of all paths that knobs are tuned on.
    judged : tuple of int
        Positions of those that policies are judged on.
    sets : tuple of tuple of int
        For each judged path, the positions of the paths that its knob is tuned on.
    """

    training: tuple[int, ...]
    judged: tuple[int, ...]
    sets: tuple[tuple[int, ...], ...]


def rotate(paths: int, variations: int) -> Rotation:
    """Return who is tuned and judged on what.

    With one path alone, knobs are tuned on its variations, whose positions come after it.
    """
    if paths == 1:
        training = tuple(range(1, 1 + variations)) or (0,)
        return Rotation(training, (0,), (training,))
    sets: dict[int, tuple[int, ...]] = {}
    for fold in folds(paths):
        for path in fold.judge.tolist():
            sets[path] = tuple(fold.train.tolist())
    everyone = tuple(range(paths))
    return Rotation(everyone, everyone, tuple(sets[path] for path in everyone))


def tune(replays: Replays, rotation: Rotation, budget_ms: float, seed: int) -> dict[str, Tuned]:
    """Replay knobs until every training set knows its operating point; return them by label.

    A policy that fails on the way is left out; `Replays.failures` says why.
    """
    knobs = replays.bench.knobs
    values = {label: list(knob.values(FIRST_VALUES)) for label, knob in knobs.items()}
    asked: dict[str, list[float]] = values
    while asked:
        replays.make(
            Place(label, path, seed, value)
            for label, new in asked.items()
            for value in new
            for path in rotation.training
        )
        asked = {}
        for label in values.keys() - replays.failures.keys():
            after = _next(replays, rotation, label, values[label], budget_ms, seed)
            if after is not None and len(values[label]) < MOST_VALUES:
                asked[label] = [after]
        asked = dict(sorted(asked.items()))
        for label, new in asked.items():
            values[label] = _ordered(knobs[label], [*values[label], *new])
    return {
        label: _chosen(replays, rotation, label, known, budget_ms, seed)
        for label, known in values.items()
        if label not in replays.failures
    }


def quantiles_ms(
    replays: Replays, label: str, values: Sequence[float], paths: Sequence[int], seed: int
) -> FloatArray:
    """Return the work time that budgets judge at each value of the knob on each path, (K, n)."""
    return np.array(
        [[replays[Place(label, path, seed, value)].judged_ms for path in paths] for value in values]
    )


def _next(
    replays: Replays,
    rotation: Rotation,
    label: str,
    values: list[float],
    budget_ms: float,
    seed: int,
) -> float | None:
    """Return the value to replay next, None where the operating points are known."""
    knob = replays.bench.knobs[label]
    work_ms = quantiles_ms(replays, label, values, rotation.training, seed)
    column = {path: at for at, path in enumerate(rotation.training)}
    sets = dict.fromkeys((rotation.training, *rotation.sets))
    training = [np.array([column[path] for path in paths]) for paths in sets]
    after = next_knob(np.array(values), work_ms, budget_ms, knob.scale, training)
    if after is None:
        return None
    short = float(f"{after:.4g}")
    return None if short in values else short


def _chosen(
    replays: Replays,
    rotation: Rotation,
    label: str,
    values: list[float],
    budget_ms: float,
    seed: int,
) -> Tuned:
    def point(paths: tuple[int, ...]) -> OperatingPoint:
        work_ms = quantiles_ms(replays, label, values, paths, seed)
        return operating_point(np.array(values), work_ms, budget_ms)

    of_set = {paths: point(paths).value for paths in dict.fromkeys(rotation.sets)}
    judged = np.array([of_set[paths] for paths in rotation.sets])
    return Tuned(np.array(values), point(rotation.training), judged)


def _ordered(knob: Knob, values: list[float]) -> list[float]:
    return sorted(values, reverse=knob.finer == "lower")
