"""The contract checks themselves: a sound policy passes, and each check finds one broken policy."""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Capabilities, Claims
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.testing import CHECKS, CheckError, check_policy

ROOT = Path(__file__).parents[2]


@dataclass
class Sound:
    """A level every `step_m` metres; broken policies differ from it in one thing."""

    step_m: float = 10.0
    capabilities: ClassVar[Capabilities] = Capabilities()
    claims: ClassVar[Claims] = Claims(settles_frames=0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget."""

    def select(self, view: View) -> Selection:
        """Return levels by distance."""
        return Selection(view.ids, self.levels(view, view.distance_m / self.step_m))

    def levels(self, view: View, level: Any) -> Any:
        """Return whole levels that there are."""
        coarsest = view.scene.types.levels.level_count[view.type_index] - 1.0
        return np.clip(np.floor(level), 0.0, coarsest)


class NotANumber(Sound):
    """Returns a detail of NaN in one frame."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        detail = super().select(view).detail
        if view.frame == 7:
            detail[0] = np.nan
        return Selection(view.ids, detail)


class NeedsObjects(Sound):
    """Asks for the nearest object of a frame without objects."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        nearest_m = view.distance_m.min()
        return Selection(view.ids, self.levels(view, view.distance_m - nearest_m))


class NeedsTwo(Sound):
    """Asks for the second nearest object of a scene that has one."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        np.partition(view.scene.center_m[:, 1], 1)
        return super().select(view)


class WholeMilliseconds(Sound):
    """Divides by a budget that it has rounded."""

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare."""
        self.step_m = 10.0 + 0.0 / round(1e3 * budget_ms)


class ForgetsThatAllIsThere(Sound):
    """Draws less where something could be missing."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        streamed = view.state.residency is not None
        return Selection(view.ids, self.levels(view, view.distance_m / 10.0 + streamed))


class DrawsLeaves:
    """Draws all leaves of a tree, in memory or not."""

    capabilities: ClassVar[Capabilities] = Capabilities(levels=False, hierarchy=True, loader=True)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Forget."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        leaf = np.diff(view.scene.child_start) == 0
        ids = np.flatnonzero(leaf & view.state.inside).astype(np.int32)
        return Selection(ids, np.zeros(len(ids)))


class CountsInstances(Sound):
    """Keeps something on the class."""

    made: ClassVar[list[object]] = []

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare."""
        self.made.append(self)
        self.step_m = 5.0 + len(self.made)


@dataclass
class Remembers(Sound):
    """Forgets nothing on a reset."""

    frames: int = field(init=False, default=0)

    def select(self, view: View) -> Selection:
        """Return levels."""
        self.frames += 1
        return Selection(view.ids, self.levels(view, view.distance_m / 10.0 + 0.1 * self.frames))


class WritesState(Sound):
    """Takes the simulator's record of details for its own."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        selection = super().select(view)
        view.state.last_detail[view.ids] = selection.detail
        return selection


class ReusesItsArray(Sound):
    """Returns the same array every time, so that its last selection changes."""

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare."""
        self.all = np.zeros(len(scene))

    def select(self, view: View) -> Selection:
        """Return levels."""
        detail = self.all[: len(view.ids)]
        detail[:] = super().select(view).detail
        return Selection(view.ids, detail)


class ByNumber(Sound):
    """Favours nodes of low numbers."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        return Selection(view.ids, self.levels(view, view.ids / 6.0))


class HoldsAFunction(Sound):
    """Holds what cannot be sent to another process."""

    def __init__(self, step_m: float = 10.0) -> None:
        super().__init__(step_m)
        self.half: Callable[[float], float] = lambda x: 0.5 * x


class ChangesItsParameter(Sound):
    """Stores a parameter in another unit."""

    def __init__(self, step_m: float = 10.0) -> None:
        super().__init__(step_m + 1.0)


class RenamesItsParameter(Sound):
    """Stores a parameter under another name."""

    def __init__(self, near_m: float = 10.0) -> None:
        super().__init__(near_m)


@dataclass(slots=True)
class ComparesUnsetState:
    """Has state in its equality, which is not there before a reset."""

    _scene: Scene = field(init=False)
    capabilities: ClassVar[Capabilities] = Capabilities()

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Keep the scene."""
        self._scene = scene

    def select(self, view: View) -> Selection:
        """Return levels."""
        return Selection(view.ids, np.zeros(len(view.ids)))


@dataclass
class Believes(Sound):
    """Goes a level finer whenever a report of this kind arrives."""

    kind: str = "zero"
    seen: int = field(init=False, default=0)
    finer: float = field(init=False, default=0.0)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare."""
        self.seen, self.finer = 0, 0.0

    def select(self, view: View) -> Selection:
        """Return levels."""
        times_ms = view.completed.work_ms
        if len(times_ms) > self.seen:
            self.seen = len(times_ms)
            repeated = len(times_ms) > 1 and times_ms[-1] == times_ms[-2]
            kind = "missing" if np.isnan(times_ms[-1]) else "stale" if repeated else "good"
            kind = "zero" if times_ms[-1] == 0.0 else kind
            self.finer += kind == self.kind
        return Selection(view.ids, self.levels(view, view.distance_m / 10.0 - self.finer))


class Spends(Sound):
    """Claims a budget that it does not know."""

    claims: ClassVar[Claims] = Claims(budget=True)


class PredictsTooMuch(Sound):
    """Claims a budget, and predicts that it does not keep it."""

    claims: ClassVar[Claims] = Claims(budget=True)

    def select(self, view: View) -> Selection:
        """Return levels."""
        cheap = self.levels(view, np.full(len(view.ids), 9.0))
        finer = np.maximum(cheap - (np.arange(len(cheap)) == 0), 0.0)
        return Selection(view.ids, finer, predicted_ms=1e3)


class WastesBudget(Sound):
    """Draws less when it has more to spend."""

    claims: ClassVar[Claims] = Claims(monotone=True)

    def reset(self, scene: Scene, budget_ms: float) -> None:
        """Prepare."""
        self.step_m = 10.0 / (1.0 + budget_ms)


class Alternates(Sound):
    """Comes to no rest."""

    def select(self, view: View) -> Selection:
        """Return levels."""
        return Selection(view.ids, self.levels(view, view.distance_m / 10.0 + view.frame % 2))


class WithoutHysteresis(Sound):
    """Claims a hysteresis that it has not."""

    claims: ClassVar[Claims] = Claims(hysteresis=True)


@dataclass
class HoldsArrays(Sound):
    """Sound, with an array that is given and one that it makes for itself."""

    near_m: Any = field(default_factory=lambda: np.array([1.0, 2.0]))
    shares: Any = field(init=False, repr=False, default_factory=lambda: np.ones(2))


class FitsNothing(Sound):
    """Selects neither levels nor resolutions nor fronts."""

    capabilities: ClassVar[Capabilities] = Capabilities(levels=False)


BROKEN: list[tuple[Callable[..., Any], str, str]] = [
    (NotANumber, "valid_selections", r"levels, frame 7: detail of node \d+: expected a level from"),
    (NeedsObjects, "empty_frames", "levels, frame 0: ValueError: zero-size array"),
    (NeedsTwo, "one_object", "levels, frame 0: ValueError: kth"),
    (WholeMilliseconds, "next_to_no_budget", "levels, reset: ZeroDivisionError"),
    (
        ForgetsThatAllIsThere,
        "everything_resident",
        "with everything in memory: node 0 has detail 0 and 1",
    ),
    (DrawsLeaves, "draws_what_is_resident", "tree, frame 0: ids: expected nodes in memory"),
    (
        CountsInstances,
        "two_instances_agree",
        r"of a second instance: node \d+ has detail \d and \d",
    ),
    (Remembers, "reset_forgets", r"node \d+ has detail \d and \d"),
    (
        WritesState,
        "leaves_the_view_alone",
        "frame 0: ValueError: assignment destination is read-only",
    ),
    (ReusesItsArray, "leaves_the_view_alone", "previous.detail was changed"),
    (
        ByNumber,
        "order_does_not_matter",
        r"levels, frame 0 with the same .*: node \d+ has detail \d and \d",
    ),
    (HoldsAFunction, "pickles", "lambda"),
    (ChangesItsParameter, "parameters_round_trip", "{'step_m': 11.0} come back as .*12.0"),
    (RenamesItsParameter, "parameters_round_trip", "near_m is not stored under its name"),
    (ComparesUnsetState, "parameters_round_trip", "needs a reset: .*_scene"),
    (partial(Believes, kind="zero"), "faulty_timings_never_raise_detail", "zero reports after 0"),
    (partial(Believes, kind="missing"), "faulty_timings_never_raise_detail", "missing reports"),
    (partial(Believes, kind="stale"), "faulty_timings_never_raise_detail", "stale reports after 4"),
    (Spends, "lag_is_bounded", r"frame \d is shown .* ms after its input"),
    (Spends, "budget_is_kept", "frame 0: expected at most .* ms, predicted nan, drew"),
    (PredictsTooMuch, "budget_is_kept", "predicted 1000, drew"),
    (WastesBudget, "more_budget_is_never_worse", "levels, benefit .* with .* ms"),
    (Alternates, "nothing_toggles_at_rest", "from frame 0 to 1, at rest, node"),
    (Alternates, "load_steps_settle", r"from frame \d+ to \d+, at rest, node"),
    (WithoutHysteresis, "hysteresis_holds", r"levels, node \d+ switches twice at"),
]


@pytest.mark.parametrize(("factory", "name", "message"), BROKEN)
def test_each_check_finds_what_it_is_for(
    factory: Callable[..., Any], name: str, message: str
) -> None:
    """A policy with one fault fails the check against it, with a message that says where."""
    (check,) = (check for check in CHECKS if check.name == name)
    with pytest.raises(CheckError, match=message):
        check(factory)


def test_every_check_has_a_broken_policy() -> None:
    """No check is without a policy that fails it."""
    assert {name for _, name, _ in BROKEN} == {check.name for check in CHECKS}


def test_a_sound_policy_passes() -> None:
    """One that claims to settle is held to that, and not to what it does not claim."""
    results = check_policy(Sound)
    assert [result.name for result in results] == [check.name for check in CHECKS]
    assert [result for result in results if not result.passed] == []
    skipped = {result.name: result.skipped for result in results if result.skipped}
    assert skipped == {
        "draws_what_is_resident": "needs no loader",
        "budget_is_kept": "does not claim budget",
        "lag_is_bounded": "does not claim budget",
        "more_budget_is_never_worse": "does not claim monotone",
        "hysteresis_holds": "does not claim hysteresis",
    }


def test_a_fault_in_one_thing_fails_no_other_check() -> None:
    """Results name the check that fails and say what is wrong; the others pass."""
    failed = [result for result in check_policy(ByNumber) if not result.passed]
    assert [result.name for result in failed] == ["order_does_not_matter"]
    assert re.search(
        "levels, frame 0 with the same nodes in another order: node", failed[0].message
    )


def test_a_policy_that_cannot_be_made_fails_every_check() -> None:
    """An error of the constructor is a result, not a crash."""

    def refuse() -> Any:
        raise TypeError("no such parameter")

    results = check_policy(refuse)
    assert not any(result.passed for result in results)
    assert all("TypeError: no such" in result.message for result in results)


def test_arrays_are_parameters_too() -> None:
    """Arrays are compared by what they hold, and an array of the policy's own is no parameter."""
    assert [result for result in check_policy(HoldsArrays) if not result.passed] == []


def test_messages_name_the_line() -> None:
    """The line that raised, in the policy's own file, or else that of the class."""
    source = Path(__file__).read_text(encoding="utf-8").splitlines()
    for policy, line in (
        (NeedsObjects, "        nearest_m = view.distance_m.min()"),
        (NotANumber, "class NotANumber(Sound):"),
    ):
        results = {result.name: result for result in check_policy(policy)}
        name = "empty_frames" if policy is NeedsObjects else "valid_selections"
        file, number, _ = results[name].message.split(":", 2)
        assert Path(file).resolve() == Path(__file__).resolve()
        assert source[int(number) - 1] == line


def test_a_policy_that_fits_no_scene_is_skipped() -> None:
    """With no capability at all there is nothing to check."""
    results = check_policy(FitsNothing)
    assert all(result.passed for result in results)
    assert results[0].skipped == "fits none of the scenes"
