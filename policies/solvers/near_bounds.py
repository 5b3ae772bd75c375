"""Which bounds on one side a search meets next, from pass to pass.

All variables move towards one target, which changes a little with each pass.  Those that meet their
bounds first are known for some passes ahead: with targets up to a limit no other gets to its bound
before a certain share of the way has been covered.  Until then only these few are looked at.
"""

import math
from typing import NamedTuple

import numpy as np

from ...base.arrays import FloatArray, IntArray

_MARGIN = 1.02
"""Factor by which the target may move before all bounds are looked at again."""

_FEW = 16
"""Bounds that are looked at from pass to pass."""


class Where(NamedTuple):
    """Where free variables are, at ``part · place + rest``, (n,), and their target."""

    place: FloatArray
    part: float
    rest: float
    target: float


class Meeting(NamedTuple):
    """A share of the way to the target, 1 for no bound on it, and who meets its bound there."""

    length: float
    variables: IntArray | list[int]


class NearBounds:
    """Upper bounds of n variables.

    Lower bounds are upper ones of the variables, places and targets with another sign.
    """

    def __init__(self, bound: FloatArray, sign: float) -> None:
        """Take the bounds, (n,), infinite for what is held, and the sign that makes upper ones."""
        self._bound, self._sign = bound, sign
        self.forget()

    def renew(self, variable: int, bound: float) -> None:
        """Take the bound of a variable that is let go of; all places have changed."""
        self._bound[variable] = self._sign * bound
        self.forget()

    def forget(self) -> None:
        """Look at all bounds at the next question."""
        self._few: dict[int, tuple[float, float]] = {}  # bound and place of each
        self._limit, self._beyond, self._part = -math.inf, 0.0, 1.0

    def strike(self, held: IntArray | list[int]) -> None:
        """Look at variables no more, as they are held."""
        self._bound[held] = math.inf
        if len(held) <= _FEW:
            for variable in held:
                self._few.pop(int(variable), None)
        else:
            few = self._few.items()
            self._few = {each: data for each, data in few if self._bound[each] < math.inf}

    def first(self, where: Where) -> Meeting:
        """Return the first bound met among the few; it is right if `sure` says so."""
        return self._among_few(where) if self._few else Meeting(1.0, [])

    def sure(self, where: Where, length: float) -> bool:
        """Return whether none but the few meets its bound within a share of the way.

        Since all were looked at, so much of the way to the limit is covered at most.
        """
        within = self._sign * where.target <= self._limit
        return within and 1.0 - where.part * (1.0 - length) / self._part < self._beyond

    def _among_few(self, where: Where) -> Meeting:
        part, rest, target = where.part, self._sign * where.rest, self._sign * where.target
        length, met = 1.0, list[int]()
        for variable, (bound, place) in self._few.items():
            if bound >= target:
                continue
            # Rounding may have carried it past the bound, which is not the way.
            here = part * place + rest
            way = (bound - here) / (target - here) if here < bound else 0.0
            if way < length:
                length, met = way, [variable]
            elif way == length:
                met.append(variable)
        return Meeting(length, met)

    def first_of_all(self, where: Where) -> Meeting:
        """Return the first bound met, and note which few come next."""
        target = self._sign * where.target
        limit = target * _MARGIN if target > 0.0 else target / _MARGIN
        at = (self._bound < limit).nonzero()[0]
        if not len(at):
            self._few, self._beyond = {}, math.inf
            self._limit, self._part = limit, where.part
            return Meeting(1.0, at)
        bound, place = self._bound[at], self._sign * where.place[at]
        here = np.minimum(where.part * place + self._sign * where.rest, bound)
        room = bound - here
        length, met = 1.0, at[:0]
        before = bound < target
        if before.any():
            way = np.divide(room, target - here, out=np.ones(len(at)), where=before)
            length = float(way.min())
            met = at[way <= length]
        # Where many meet their bounds at once, as they do at first, the target moves far.
        if len(met) > _FEW:
            self.forget()
        else:
            self._note_few(at, bound, place, room / (limit - here))
            self._limit, self._part = limit, where.part
        return Meeting(length, met)

    def _note_few(
        self, at: IntArray, bound: FloatArray, place: FloatArray, far: FloatArray
    ) -> None:
        """Note who comes first on the way to the limit, and where the others begin."""
        few, self._beyond = np.arange(len(at)), math.inf
        if len(at) > _FEW:
            few = np.argpartition(far, _FEW)
            self._beyond, few = float(far[few[_FEW]]), few[:_FEW]
        values = zip(bound[few].tolist(), place[few].tolist(), strict=True)
        self._few = dict(zip(at[few].tolist(), values, strict=True))
