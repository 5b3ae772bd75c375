"""A policy that is watched: what it last saw and chose, and how long each choice took."""

import time
from typing import ClassVar, TypeVar

from ...models.scene.scene import Scene
from ..protocol import Capabilities, Clairvoyant, Policy, Truth
from ..selection import Selection
from ..view import View


class Watched:
    """A policy and what became of its choices.

    Attributes
    ----------
    last : the newest view and selection, None and None before the first
    select_ms : wall-clock time of each call of `select`
    """

    capabilities: ClassVar[Capabilities] = Capabilities()  # replaced by those of the policy

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self.last: tuple[View | None, Selection | None] = (None, None)
        self.select_ms: list[float] = []

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Reset the policy."""
        self._policy.reset(scene, budget_ms)

    def select(self, view: View) -> Selection:
        """Let the policy select, and keep both sides and the time between them."""
        start = time.perf_counter_ns()
        selection = self._policy.select(view)
        self.select_ms.append((time.perf_counter_ns() - start) * 1e-6)
        self.last = (view, selection)
        return selection

    def foresee(self, truth: Truth) -> None:
        """Hand on the truth, which the replay tells oracles only."""
        assert isinstance(self._policy, Clairvoyant)
        self._policy.foresee(truth)


Kind = TypeVar("Kind", bound=Watched)


def watch(policy: Policy, kind: type[Kind] = Watched) -> Kind:
    """Return the policy watched, with its capabilities, as a replay reads them of the class."""
    watched = type("Watched", (kind,), {"capabilities": policy.capabilities})(policy)
    assert isinstance(watched, kind)
    return watched
