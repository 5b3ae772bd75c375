"""Selections that would break what comes after them are named by the contract checks."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities
from lodbench.policies.selection import Selection, Work
from lodbench.policies.view import View
from lodbench.testing import check_policy

Spoil = Callable[[Selection], Any]


class RaisingError(Exception):
    """An exception that cannot be printed."""

    def __str__(self) -> str:
        """Raise."""
        raise RuntimeError


def spoilt_by(spoil: Spoil) -> Any:
    """Return a policy that is sound up to its fourth frame, whose selection is changed."""

    class Spoilt:
        capabilities: ClassVar[Capabilities] = Capabilities()

        def reset(self, scene: Scene, budget_ms: float) -> None:
            """Forget."""

        def select(self, view: View) -> Any:
            """Draw everything."""
            good = Selection(view.ids, np.zeros(len(view.ids)))
            return spoil(good) if view.frame == 3 else good

    return Spoilt


def work(**counts: Any) -> Spoil:
    """Return what gives a selection another work."""
    return lambda good: replace(good, work=Work(**counts))


def raises(error: BaseException) -> Spoil:
    """Return what raises in place of a selection."""

    def spoil(_: Selection) -> Any:
        raise error

    return spoil


HOSTILE: dict[str, tuple[Spoil, str]] = {
    "huge work": (
        work(objects_visited=10**400),
        "work: expected objects_visited from 0 to 1e+12, got 1000000000",
    ),
    "complex work": (work(comparisons=1j), "work: expected comparisons from 0 to 1e+12, got 1j"),
    "masked work": (
        work(iterations=np.ma.masked),
        "work: expected iterations from 0 to 1e+12, got --",
    ),
    "infinite prediction": (
        lambda good: replace(good, predicted_ms=np.inf),
        "predicted_ms: expected milliseconds from 0 to 1e+09 or NaN, got inf",
    ),
    "invisible picture": (
        lambda good: replace(good, render_scale=1e-300),
        "render_scale: expected a number from 0.0010 to 1, got 1e-300",
    ),
    "masked detail": (
        lambda good: replace(good, detail=np.ma.masked_array(good.detail)),
        "detail: expected a one-dimensional numpy array, got MaskedArray",
    ),
    "complex detail": (
        lambda good: replace(good, detail=good.detail.astype(complex)),
        "detail: expected float64, got complex128",
    ),
    "infinite detail": (
        lambda good: replace(good, detail=good.detail + np.inf),
        ": expected a level from 0 to",
    ),
    "endless ids": (
        lambda good: Selection(
            np.broadcast_to(np.int64(0), (10**12,)), np.broadcast_to(0.0, (10**12,))
        ),
        "ids: expected distinct nodes, got 1000000000000 of",
    ),
    "an exception that raises": (raises(RaisingError()), "frame 3: RaisingError"),
    "an exception of many lines": (
        raises(ValueError("\x1b[2J\n" * 1000)),
        "ValueError: ?[2J ?[2J",
    ),
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_selection_fails_the_policy_in_one_line(name: str) -> None:
    """The first check names the frame, the field, and what was got, however it may be printed."""
    spoil, message = HOSTILE[name]
    first = check_policy(spoilt_by(spoil))[0]
    assert first.name == "valid_selections"
    assert not first.passed
    assert "frame 3: " in first.message
    assert message in first.message
    assert "\n" not in first.message
    assert len(first.message) < 600


def test_what_is_changed_in_nothing_passes() -> None:
    """The policy that all of these spoil is sound without it."""
    assert check_policy(spoilt_by(lambda good: good))[0].passed
