"""Which policies fit which scenes."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.protocol import Capabilities, Claims, Policy, why_not_applicable
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


@pytest.mark.parametrize("value", [1, None, "yes", np.True_, 10**400])
def test_capabilities_are_true_or_false(value: Any) -> None:
    """A number or a word that counts as true is none, and is told where it is given."""
    for name in ("levels", "continuous", "hierarchy", "loader", "future"):
        with pytest.raises(InputError, match=f"capabilities: {name}: expected True or False, got"):
            Capabilities(**{name: value})
    with pytest.raises(InputError, match="claims: budget: expected True or False, got"):
        Claims(budget=value)


@pytest.mark.parametrize(
    ("value", "got"), [(-1, "-1"), (True, "True"), (0.5, "0.5"), (10**400, "1000000000")]
)
def test_claims_of_rest_are_frames_that_can_be_waited_for(value: Any, got: str) -> None:
    """A replay of 10**400 frames would never end."""
    with pytest.raises(InputError, match=f"expected None or 0 to 1000000 frames, got {got}"):
        Claims(settles_frames=value)
    assert Claims(settles_frames=1_000_000).settles_frames == 1_000_000
