"""The fixed examples of each kind of promise, in all places that a policy can drive."""

from collections.abc import Callable, Iterator
from itertools import islice, pairwise
from typing import Any

import numpy as np

from ...policies.protocol import Policy
from ..promises.promise import Examples
from .example import Example
from .fixed_examples import (
    AWAY,
    NEXT_TO_NOTHING,
    PLENTY,
    SIGHT,
    TIGHT,
    WALK,
    example_at,
    fitting,
    pose_at,
)

BUDGETS = (NEXT_TO_NOTHING, 0.1, TIGHT, 0.8, PLENTY)
CUT = (*WALK[6:9], SIGHT)
EMPTY_WALK = (AWAY, WALK[0], WALK[1], AWAY, AWAY, WALK[2])
LONE_WALK = (*WALK[:3], AWAY, WALK[0])

_STEPS = tuple(pose_at(0.05 * k) for k in range(80))
BACK_AND_FORTH = (
    *_STEPS[:1] * 30,
    *(pose for back, forth in pairwise(_STEPS) for pose in (forth, back, forth)),
)


Frames = Callable[[int], int]


def long_rest(rest: int) -> int:
    """Return the frames of a cut, of coming to rest, and some in which nothing may change."""
    return len(CUT) + 3 + rest + max(40, min(rest, 200))


def walks(
    *shares: float, lone: bool = False, frames: Frames | None = None, **more: Any
) -> Examples:
    """Return examples with budgets of these shares in every place, other arguments as they are.

    `frames` is a function of the frames that a policy takes to rest.
    """

    def examples(policy: Policy, rest: int) -> Iterator[Example]:
        count = 0 if frames is None else frames(rest)
        for place in fitting(policy.capabilities, lone=lone):
            for share in shares:
                yield example_at(place, share, frames=count, **more)

    return examples


def first_walk(policy: Policy, rest: int) -> Iterator[Example]:
    """Yield the walk in the first place only."""
    return islice(walks(TIGHT)(policy, rest), 1)


def shuffled(policy: Policy, rest: int) -> Iterator[tuple[Example, int]]:
    """Yield walks, and a seed by which nodes are renumbered."""
    return ((example, 7) for example in walks(TIGHT)(policy, rest))


def after_another(policy: Policy, _rest: int) -> Iterator[tuple[Example, Example]]:
    """Yield pairs: what is played before is another scene, with less budget, from the end on."""
    chosen = list(fitting(policy.capabilities))
    for place, other in zip(chosen, (*chosen[1:], *chosen[:1]), strict=True):
        yield example_at(other, 0.5 * TIGHT, WALK[:9:-1]), example_at(place, TIGHT)


def growing(policy: Policy, _rest: int) -> Iterator[tuple[Example, Example]]:
    """Yield pairs of one budget and the next, in flat scenes."""
    for place in fitting(policy.capabilities):
        if place.scene.flat:
            shares = np.linspace(-0.3, 1.2, 26).tolist()
            yield from pairwise(example_at(place, x, (SIGHT,), frames=2) for x in shares)


def slow_frames(policy: Policy, _rest: int) -> Iterator[Example]:
    """Yield a flat scene and a tree at rest, a second a frame: who waits has waited."""
    of_each_kind = {place.scene.flat: place for place in fitting(policy.capabilities)}
    for place in of_each_kind.values():
        for share in (0.3, PLENTY):
            yield example_at(place, share, (SIGHT,), refresh_hz=1.0, frames=20)
