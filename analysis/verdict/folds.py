"""Which paths a policy's knob is chosen on, and which it is judged on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

_FOLDS = 5


@dataclass(frozen=True, slots=True, eq=False)
class Fold:
    """One turn of the rotation.

    Attributes
    ----------
    train, judge : (t,), (j,) int64
        Indices of the paths that the knob is chosen on, and of those that it is judged on.
    """

    train: NDArray[np.int64]
    judge: NDArray[np.int64]


def folds(n: int) -> tuple[Fold, ...]:
    """Return the rotation over n paths, in which every path is judged once.

    Five turns from 5 paths on, path i in turn i mod 5; one path a turn for 2 to 4.  A single path
    is judged in one turn that trains on it too: whoever has only one trains on its variations.
    """
    assert n >= 1
    paths = np.arange(n)
    if n == 1:
        return (Fold(paths, paths),)
    turn = paths % min(n, _FOLDS)
    return tuple(Fold(paths[turn != k], paths[turn == k]) for k in range(min(n, _FOLDS)))
