"""Which policies fit which scenes."""

from collections.abc import Callable

import pytest

from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.protocol import Capabilities, Policy, why_not_applicable
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.policies.thresholds.static_screen import StaticScreen

DISCRETE, CONTINUOUS, MIXED, TREE = range(4)


@pytest.fixture(scope="module")
def scenes(make_scene: Callable[..., Scene], make_levels: Callable[..., LevelTable]) -> list[Scene]:
    """Return a discrete, a continuous and a mixed flat scene, and a tree."""
    two = [(10, 5), (10, 5)]
    places = [(0.0, 0.0, 0.0)] * 2
    return [
        make_scene(places, kind=[0, 1], levels=make_levels(two)),
        make_scene(places, kind=[0, 1], levels=make_levels(two, continuous=True)),
        make_scene(places, kind=[0, 1], levels=make_levels(two, continuous=[True, False])),
        make_scene(places, parent=[-1, 0]),
    ]


@pytest.mark.parametrize(
    ("capabilities", "fits"),
    [
        (Capabilities(), {DISCRETE}),
        (Capabilities(continuous=True), {DISCRETE, CONTINUOUS, MIXED}),
        (Capabilities(levels=False, continuous=True), {CONTINUOUS}),
        (Capabilities(levels=False, hierarchy=True), {TREE}),
        (Capabilities(hierarchy=True), {DISCRETE, TREE}),
    ],
)
def test_a_policy_fits_what_it_can_drive(
    scenes: list[Scene], capabilities: Capabilities, fits: set[int]
) -> None:
    """A reason is given exactly for the scenes that a policy's capabilities do not cover."""
    reasons = [why_not_applicable(capabilities, scene) for scene in scenes]
    assert {i for i, reason in enumerate(reasons) if reason is None} == fits
    for reason in filter(None, reasons):
        assert reason.startswith("the scene ")


@pytest.mark.parametrize("cls", [Full, StaticDistance, StaticScreen, Feedback])
def test_policies_follow_the_protocol(scenes: list[Scene], cls: Callable[[], Policy]) -> None:
    """Each has capabilities, ``reset`` and ``select``, and drives discrete levels."""
    policy = cls()
    assert isinstance(policy, Policy)
    assert why_not_applicable(policy.capabilities, scenes[DISCRETE]) is None
