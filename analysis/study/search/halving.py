"""Successive halving: all trials on few paths, the best of them on more, the last on all.

Most trials are plainly worse than the best, which few paths show; where replays are dear, they are
spent on those that could be the best.

Source: Jamieson and Talwalkar, AISTATS 2016, section 3, with thirds for halves.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil

import numpy as np

from ....base.errors import InputError
from ...verdict.answer import SEEN
from ...verdict.chances import order_chances
from ...verdict.judged import Judged
from ...verdict.keeping import p_keeps
from ...verdict.operating_point import SURE
from ...verdict.verdict import order_criteria
from ..judging import Judging
from ..replays import Place, Replays
from ..tuning import Rotation, tune

FIRST_PATHS = 4
"""Paths of the first round: the fewest from which a spread is estimated."""

_KEPT = 3  # of so many trials one goes on to the next round


@dataclass(frozen=True, slots=True)
class Tried:
    """A trial, in the last round that it was in.

    Attributes
    ----------
    judged : Judged
        On the paths that its knob was brought to the budget on.
    paths : int
        How many these are.
    """

    judged: Judged
    paths: int


def refused(replays: Replays, shipped: str, path: int, seed: int) -> dict[str, str]:
    """Return why the class refuses trials, by label, and leave them out from now on.

    Each has its first replay alone, so that what is refused is known by name.

    Raises `InputError` if the policy as shipped is refused.
    """
    reasons: dict[str, str] = {}
    labels = list(replays.bench.specs)
    for label in labels:
        knob = replays.bench.knobs.get(label)
        value = None if knob is None else knob.values(2)[0]
        try:
            replays.make([Place(label, path, seed, value)])
        except InputError as error:
            if label == shipped:
                raise
            reasons[label] = error.message
    replays.narrow(set(labels) - reasons.keys())
    return reasons


def halve(
    replays: Replays, shipped: str, training: Sequence[int], margin: float
) -> tuple[dict[str, Tried], str]:
    """Try policies on ever more training paths; return each trial, and who is best at last.

    The policy as shipped stays to the end, as long as it does not fail.

    Parameters
    ----------
    training
        Positions of two paths or more.
    margin
        Part of the best's value within which another is as good.
    """
    tried: dict[str, Tried] = {}
    used = min(FIRST_PATHS, len(training))
    while True:
        judged = _judge(replays, tuple(training[:used]))
        order = best_first(judged, replays.bench.options.budget_ms, margin)
        tried |= {item.label: Tried(item, used) for item in judged}
        if used == len(training) or shipped in replays.failures:
            return tried, order[0] if order else shipped
        kept = order[: max(ceil(len(order) / _KEPT), 2)]
        # The failed are kept too, who cost nothing more, so that their reasons are not forgotten.
        replays.narrow({shipped, *kept, *replays.failures})
        used = min(2 * used, len(training))


def best_first(judged: Sequence[Judged], budget_ms: float, margin: float) -> list[str]:
    """Return labels by the verdict's order, as far as the paths tell: the likeliest best first.

    Those that surely keep the budget come first, by their probability of being the best, then by
    what visible error they would cost; then the others, by how much they miss it.
    """
    sure = [item for item in judged if p_keeps(item.point_ms, budget_ms) >= SURE]
    order: list[str] = []
    if sure:
        of = order_chances(order_criteria(sure, margin), regret_in=SEEN[0])
        keys = zip((-of.p_best).tolist(), of.regret.tolist(), strict=True)
        ranked = sorted(zip(keys, (item.label for item in sure), strict=True))
        order = [label for _, label in ranked]
    others = [item for item in judged if item.label not in order]
    others.sort(key=lambda item: (float(np.log(item.point_ms).mean()), item.label))
    return [*order, *(item.label for item in others)]


def _judge(replays: Replays, paths: tuple[int, ...]) -> list[Judged]:
    """Return the trials that do not fail on paths, each with its knob tuned on these very paths."""
    seed = replays.bench.options.seed
    rotation = Rotation(paths, paths, (paths,) * len(paths))
    judging = Judging(replays.bench, rotation, (seed,), ())
    replays.make(judging.as_given())
    tuned = tune(replays, rotation, replays.bench.options.budget_ms, seed)
    return judging.outcome(replays, tuned)
