"""The fixed examples of each kind of promise, in all places that a policy can drive."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from ..policies.protocol import Policy
from ..traces.cameras.camera_trace import Pose
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
from .promise import Examples

BUDGETS = (NEXT_TO_NOTHING, 0.1, TIGHT, 0.8, 1.5)
EMPTY_WALK = (AWAY, WALK[0], WALK[1], AWAY, AWAY, WALK[2])
LONE_WALK = (*WALK[:3], AWAY, WALK[0])

_REST = 40  # frames for which nothing may change once a policy has settled
_STEPS = tuple(pose_at(0.05 * k) for k in range(80))
BACK_AND_FORTH = (
    *_STEPS[:1] * 30,
    *(pose for back, forth in pairwise(_STEPS) for pose in (forth, back, forth)),
)


def walks(
    *shares: float,
    poses: tuple[Pose, ...] = WALK,
    lone: bool = False,
    refresh_hz: float = 60.0,
) -> Examples:
    """Return examples of one walk with budgets of these shares."""

    def examples(policy: Policy, _rest: int) -> Iterator[Example]:
        for place in fitting(policy.capabilities, lone=lone):
            for share in shares:
                yield example_at(place, share, poses, refresh_hz=refresh_hz)

    return examples


def one_walk(policy: Policy, rest: int) -> list[Example]:
    """Return the walk in the first place only."""
    return list(walks(TIGHT)(policy, rest))[:1]


def shuffled(policy: Policy, rest: int) -> Iterator[tuple[Example, int]]:
    """Yield walks, and a seed by which nodes are renumbered."""
    return ((example, 7) for example in walks(TIGHT)(policy, rest))


def after_another(policy: Policy, _rest: int) -> Iterator[tuple[Example, Example]]:
    """Yield pairs: what is played before is another scene, with less budget, from the end on."""
    chosen = list(fitting(policy.capabilities))
    for place, other in zip(chosen, (*chosen[1:], *chosen[:1]), strict=True):
        yield example_at(other, 0.5 * TIGHT, WALK[::-1]), example_at(place, TIGHT)


def unpaced(policy: Policy, _rest: int) -> Iterator[Example]:
    """Yield examples at rest on a screen that waits for nothing, where each frame is due."""
    for place in fitting(policy.capabilities):
        for share in BUDGETS:
            yield example_at(place, share, (SIGHT,), mode="immediate")


def resting(policy: Policy, rest: int) -> Iterator[Example]:
    """Yield examples in which nothing moves."""
    for place in fitting(policy.capabilities):
        yield example_at(place, 0.5, (SIGHT,), frames=rest + 10)


def stepping(policy: Policy, rest: int) -> Iterator[Example]:
    """Yield examples that end with a cut, after which nothing moves."""
    walk = (*WALK[6:9], SIGHT)
    frames = len(walk) + rest + max(_REST, min(rest, 5 * _REST)) + 3
    for place in fitting(policy.capabilities):
        for share in (0.15, 0.5):
            yield example_at(place, share, walk, frames=frames)


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


def streamed(policy: Policy, _rest: int) -> Iterator[Example]:
    """Yield trees of which not all fits in memory."""
    for place in fitting(policy.capabilities):
        if not place.scene.flat:
            yield example_at(place, PLENTY, memory_share=0.4)
