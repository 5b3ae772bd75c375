"""Bring every policy to its operating point: the finest knob that surely keeps the budget.

Policies that were left at somebody's defaults spend different shares of the budget, and what is
compared then is the defaults.  Each policy is tuned on some paths and judged on others, by
rotation, so that no path helps to choose the knob that it judges.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...base.arrays import FloatArray
from ...policies.knob import Knob
from ..verdict.folds import folds
from ..verdict.operating_point import (
    NARROW,
    OperatingPoint,
    keeps_surely,
    next_knob,
    operating_point,
)
from .replays import Place, Replays

SCANNED_PATHS = 4
"""Paths on which the whole range of a knob is replayed: enough to see where the budget lies, and
for curves."""
SCANNED_VALUES = 5
"""Values, the ends among them, that are replayed there before anything is known."""
_BEYOND = 0.02
"""By which a value is taken beyond where the last point of a training set should be, so that it is
surely beyond it; twice as much at every further try."""
_POINTS = 129  # at which that is looked for
MOST_VALUES = 18
"""Values of a knob that are replayed at most."""


@dataclass(frozen=True, slots=True)
class _Effort:
    """How closely a knob is looked at.

    Attributes
    ----------
    values : int
        Of the knob, its ends among them, that are replayed before anything is known.
    narrow, narrow_of_folds : float
        Width of the bracket about the operating point of all paths, and about that of a fold, whose
        paths judge at its coarse end.
    near, near_of_folds : float
        Change of the work over a bracket, as a share, that is small enough whatever its width.
    """

    values: int
    narrow: float
    narrow_of_folds: float
    near: float
    near_of_folds: float


_EFFORT = _Effort(SCANNED_VALUES, NARROW, 0.12, near=0.03, near_of_folds=0.06)
_EFFORT_OF_FEW = _Effort(3, 2.0 * NARROW, 0.2, near=0.06, near_of_folds=0.1)
"""Where all paths are scanned: each value then tells of all, so that fewer find the budget.  Of the
work, so few paths leave more open than such brackets do."""


@dataclass(frozen=True, slots=True, eq=False)
class Tuned:
    """A policy's knob, replayed and chosen.

    Attributes
    ----------
    values : (K,) float64
        What was replayed on the scanned paths, from coarse to fine.
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

    @property
    def scanned(self) -> tuple[int, ...]:
        """Positions of the paths on which the whole range of a knob is replayed."""
        return self.training[:SCANNED_PATHS]


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
    search = {
        label: _Search(replays, rotation, label, knob, budget_ms, seed)
        for label, knob in replays.bench.knobs.items()
    }
    replays.make(place for one in search.values() for place in one.scan())
    while asked := {
        label: value
        for label, one in search.items()
        if label not in replays.failures and (value := one.next_value()) is not None
    }:
        replays.make(place for label, value in asked.items() for place in search[label].ask(value))
    return {label: one.chosen() for label, one in search.items() if label not in replays.failures}


def quantiles_ms(
    replays: Replays, label: str, values: Sequence[float], paths: Sequence[int], seed: int
) -> FloatArray:
    """Return the work time that budgets judge at each value of the knob on each path, (K, n)."""
    return np.array(
        [[replays[Place(label, path, seed, value)].judged_ms for path in paths] for value in values]
    )


class _Search:
    """The search for one policy's operating points.

    Its whole range is scanned on few paths; near the budget values are replayed on all.
    """

    def __init__(
        self,
        replays: Replays,
        rotation: Rotation,
        label: str,
        knob: Knob,
        budget_ms: float,
        seed: int,
    ) -> None:
        self._replays, self._rotation = replays, rotation
        self._label, self._knob, self._budget_ms, self._seed = label, knob, budget_ms, seed
        few = rotation.scanned == rotation.training
        self._effort = _EFFORT_OF_FEW if few else _EFFORT
        self._known = list(knob.values(self._effort.values))  # on the scanned paths, coarse to fine
        self._whole = list(self._known) if few else []  # of these, on all training paths
        self._tries = 0  # to have the points of all training sets between two of these

    def scan(self) -> list[Place]:
        """Return the replays over the whole range."""
        scanned = self._rotation.scanned
        return [self._place(path, value) for value in self._known for path in scanned]

    def ask(self, value: float) -> list[Place]:
        """Return the replays of a value on all training paths."""
        if value not in self._known:
            self._known = self._ordered([*self._known, value])
        self._whole = self._ordered([*self._whole, value])
        return [self._place(path, value) for path in self._rotation.training]

    def next_value(self) -> float | None:
        """Return the value to replay next on all paths, None where all points are known."""
        if not self._whole:
            return self._first_value()
        work_ms = self._work_ms(self._whole, self._rotation.training)
        column = {path: at for at, path in enumerate(self._rotation.training)}
        sets = dict.fromkeys((self._rotation.training, *self._rotation.sets))
        training = [np.array([column[path] for path in paths]) for paths in sets]
        after: float | None = None
        sure = [keeps_surely(np.log(work_ms[:, paths] / self._budget_ms)) for paths in training]
        # Every set needs a value that keeps the budget beside a finer one that does not, or an end.
        if not all(of.any() for of in sure):
            beside = self._beyond(-1, training)
            if beside is not None:
                return beside
        if any(of[-1] for of in sure):
            beside = self._beyond(1, training)
            if beside is not None:
                return beside
        if hopeful := self._hopeful():
            return hopeful[0]
        if len(self._known) >= MOST_VALUES:
            return None
        values, scale, effort = np.array(self._whole), self._knob.scale, self._effort
        everyone, *folds = training
        for sets, narrow, near in (
            ([everyone], effort.narrow, effort.near),
            (folds, effort.narrow_of_folds, effort.near_of_folds),
        ):
            share = self._share(narrow)
            after = next_knob(values, work_ms, self._budget_ms, scale, sets, share, near)
            if after is not None:
                break
        if after is None:
            return None
        short = _short(after)
        return None if short in self._whole else short

    def chosen(self) -> Tuned:
        """Return the operating points of all training sets."""
        sets = self._rotation.sets
        of_set = {paths: self._point(paths).value for paths in dict.fromkeys(sets)}
        judged = np.array([of_set[paths] for paths in sets])
        return Tuned(np.array(self._known), self._point(self._rotation.training), judged)

    def _first_value(self) -> float:
        """Return where the budget should be, by the scanned paths: between two values that were."""
        work_ms = self._work_ms(self._known, self._rotation.scanned)
        found = operating_point(np.array(self._known), work_ms, self._budget_ms)
        values, scale = np.array(self._known), self._knob.scale
        everyone = [np.arange(len(self._rotation.scanned))]
        between = next_knob(values, work_ms, self._budget_ms, scale, everyone)
        return found.value if between is None else _short(between)

    def _share(self, narrow: float) -> float:
        """Return as a share of the whole values' range what is that share of the finest of them."""
        if self._knob.scale == "log":
            return narrow
        return narrow * abs(self._whole[-1]) / float(np.ptp(self._whole) or 1.0)

    def _hopeful(self) -> list[float]:
        """Return finer values that were scanned and seem to keep the budget, coarsest first.

        There are some only where a finer value takes less time than a coarser one.
        """
        finest = self._known.index(self._whole[-1])
        finer = self._known[finest + 1 :]
        if not finer:
            return []
        ln_ratio = np.log(self._work_ms(finer, self._rotation.scanned) / self._budget_ms)
        return [v for v, of in zip(finer, ln_ratio.mean(axis=1).tolist(), strict=True) if of <= 0.0]

    def _beyond(self, way: int, training: Sequence[NDArray[np.int64]]) -> float | None:
        """Return the value beyond which, finer (1) or coarser (-1), no set should have its point.

        Work is taken to change from the last value that was replayed on all paths as it does on the
        scanned ones in the mean.  None at an end of the range.
        """
        edge = self._whole[0 if way < 0 else -1]
        here = self._knob.where(edge)
        shares = np.linspace(here, 0.0 if way < 0 else 1.0, _POINTS)
        known = [self._knob.where(value) for value in self._known]
        ln_ms: FloatArray = np.log(self._work_ms(self._known, self._rotation.scanned)).mean(axis=1)
        rise: FloatArray = np.interp(shares, known, ln_ms) - np.interp(here, known, ln_ms)
        ln_ratio = np.log(self._work_ms([edge], self._rotation.training) / self._budget_ms)
        beyond = [
            keeps_surely(rise[:, None] + ln_ratio[:, paths]) == (way < 0) for paths in training
        ]
        last = max(int(of.argmax()) if of.any() else _POINTS - 1 for of in beyond)
        # Without a margin every other prediction would fall short, and cost another value.
        margin = abs(self._knob.where(edge * (1.0 + _BEYOND)) - self._knob.where(edge))
        margin = max(margin, 1e-3) * 2.0**self._tries
        self._tries += 1
        stepped = self._knob.at(min(max(float(shares[last]) + way * margin, 0.0), 1.0))
        return None if stepped == edge or stepped in self._whole else stepped

    def _is_monotone(self) -> bool:
        work_ms = self._work_ms(self._known, self._rotation.scanned)
        return operating_point(np.array(self._known), work_ms, self._budget_ms).monotone

    def _point(self, paths: tuple[int, ...]) -> OperatingPoint:
        work_ms = self._work_ms(self._whole, paths)
        found = operating_point(np.array(self._whole), work_ms, self._budget_ms)
        return replace(found, monotone=found.monotone and self._is_monotone())

    def _work_ms(self, values: Sequence[float], paths: Sequence[int]) -> FloatArray:
        return quantiles_ms(self._replays, self._label, values, paths, self._seed)

    def _place(self, path: int, value: float) -> Place:
        return Place(self._label, path, self._seed, value)

    def _ordered(self, values: Sequence[float]) -> list[float]:
        return sorted(set(values), reverse=self._knob.finer == "lower")


def _short(value: float) -> float:
    """Return a value with so many digits as a label shows."""
    return float(f"{value:.4g}")
