"""A watched policy: the same choices, each kept with what was seen and how long it took."""

import time
from collections.abc import Callable
from typing import ClassVar

import numpy as np
import pytest

from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.protocol import Capabilities, Clairvoyant, Policy, Truth
from lodbench.policies.registry import default_policies, parse_policy
from lodbench.policies.selection import Selection
from lodbench.policies.shared.observer import watch
from lodbench.policies.view import View


class Slow:
    """Takes 5 ms to draw everything at full detail."""

    capabilities: ClassVar[Capabilities] = Capabilities()

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Note what it is given."""
        self.given = (scene, budget_ms)

    def select(self, view: View) -> Selection:
        """Sleep, then select."""
        time.sleep(0.005)
        return Selection(view.ids, np.zeros(len(view)))


class Told(Slow):
    """An oracle that keeps what it foresees."""

    capabilities: ClassVar[Capabilities] = Capabilities(future=True)

    def foresee(self, truth: Truth) -> None:
        """Keep it."""
        self.truth = truth


def test_choices_are_kept_with_their_time(
    make_scene: Callable[..., Scene], make_view: Callable[..., View]
) -> None:
    """One time a call, of about what it took; the newest view and selection; the reset goes on."""
    policy, scene = Slow(), make_scene([(0.0, 0.0, -10.0)])
    watched = watch(policy)
    assert watched.last == (None, None)
    watched.reset(scene, 8.0)
    assert policy.given == (scene, 8.0)
    views = [make_view(scene, frame=frame) for frame in range(2)]
    selections = [watched.select(view) for view in views]
    assert watched.last == (views[1], selections[1])
    assert len(watched.select_ms) == 2
    assert all(5.0 <= took < 500.0 for took in watched.select_ms)


@pytest.mark.parametrize("name", default_policies())
def test_capabilities_are_those_of_the_policy(name: str) -> None:
    """Of the object and of its class, where a replay looks for them."""
    policy = parse_policy(name).make()
    watched = watch(policy)
    assert watched.capabilities == policy.capabilities
    assert type(watched).capabilities == policy.capabilities
    assert isinstance(watched, Policy)


def test_watching_one_changes_no_other() -> None:
    """Each watched policy has capabilities of its own."""
    first, second = watch(Told()), watch(Full())
    assert first.capabilities.future
    assert not second.capabilities.future


def test_the_truth_is_handed_to_an_oracle() -> None:
    """As it was given."""
    oracle = Told()
    watched = watch(oracle)
    assert isinstance(watched, Clairvoyant)
    truth = Truth(CostModel.of(1.0, {}), 1.25)
    watched.foresee(truth)
    assert oracle.truth is truth
