"""Every policy of the package names what trades its picture for time, and it does."""

import inspect
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.scene.scene import Scene
from lodbench.policies.knob import Knob, knob_of
from lodbench.policies.policy_spec import PolicySpec
from lodbench.policies.protocol import claims_of, why_not_applicable
from lodbench.policies.registry import REGISTERED, parse_policy, vary_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.testing.examples.small_scenes import small_scenes
from lodbench.traces.cameras.orientation import look_along

Run = Callable[..., FrameLog]

WITHOUT = ("full", "oracle")
TURNED = [name for name in REGISTERED if name not in WITHOUT]
AIMED = [name for name in TURNED if getattr(knob_of(parse_policy(name)), "name", "") == "aim"]
FULL_MS = 12.0


def knob(name: str) -> Knob:
    """Return the knob of a policy that has one."""
    found = knob_of(parse_policy(name))
    assert found is not None
    return found


def fitting(name: str) -> list[Scene]:
    """Return the small scenes that a policy can drive."""
    capabilities = parse_policy(name).make().capabilities
    return [scene for scene in small_scenes() if not why_not_applicable(capabilities, scene)]


@pytest.fixture(scope="module")
def run(make_hardware: Callable[..., Any], make_trace: Callable[..., Any]) -> Run:
    """Return a function that replays a walk of 3 s on which full detail takes some 12 ms."""
    position_m = np.column_stack((np.zeros(2), (0.0, 6.0), np.zeros(2)))
    turned = look_along(np.full(2, 0.5 * np.pi), np.zeros(2))
    trace = make_trace(position_m, time_s=(0.0, 3.0), orientation_xyzw=turned)

    def play(
        spec: PolicySpec, scene: Scene, budget_ms: float, frames: int | None = None
    ) -> FrameLog:
        levels = scene.types.levels
        leaves = np.setdiff1d(np.arange(len(scene)), scene.parent)
        finest = levels.start[:-1][scene.type_index[leaves]]
        triangles = levels.counts[finest, LEVEL_PREDICTORS.index("triangles")].sum()
        machine = make_hardware(
            {"triangles": FULL_MS / float(triangles)}, mode="vsync", width_px=1280, height_px=720
        )
        options = ReplayOptions(budget_ms=budget_ms, frames=frames)
        return replay(spec.make(), scene, trace, machine, options, name=spec.label)

    return play


def test_policies_without_a_knob_say_why() -> None:
    """A line of the docstring that begins with ``Knob: none`` and goes on."""
    for name in REGISTERED:
        spec = parse_policy(name)
        says = "Knob: none, " in (inspect.getdoc(spec.cls) or "")
        assert (knob_of(spec) is None) == (name in WITHOUT) == says, name


@pytest.mark.parametrize("name", TURNED)
def test_the_shipped_value_lies_within_the_range(name: str) -> None:
    """What a policy does untuned is one of its operating points."""
    shipped = getattr(parse_policy(name).make(), knob(name).name)
    if name == "predictive":  # none of its own: that of the policy inside
        assert shipped is None
        return
    assert knob(name).low <= shipped <= knob(name).high


@pytest.mark.parametrize("name", TURNED)
def test_the_fine_end_is_finer_and_takes_longer(name: str, run: Run) -> None:
    """In the first small scene that fits: less error, more time, and the budget kept when coarse.

    From one second on, so that controllers have got there.
    """
    scene, turned = fitting(name)[0], knob(name)
    coarse, _, fine = (
        run(vary_policy(parse_policy(name), {turned.name: value}), scene, 6.0)
        for value in turned.values(3)
    )
    error_px = [float(np.nanmean(log["sse_px_p95"][60:])) for log in (coarse, fine)]
    work_ms = [float(np.mean(log["gpu_ms"][60:])) for log in (coarse, fine)]
    assert error_px[1] < error_px[0]
    assert work_ms[1] > 1.2 * work_ms[0]
    assert work_ms[0] < 6.0


@pytest.mark.parametrize("name", AIMED)
def test_half_the_aim_is_half_the_budget(name: str, run: Run) -> None:
    """Every frame is that of the policy which has half the budget and may take all of it."""
    spec = parse_policy(name)
    for scene in fitting(name):
        half = run(vary_policy(spec, {"aim": 0.5}), scene, 8.0, 20)
        small, whole = run(spec, scene, 4.0, 20), run(spec, scene, 8.0, 20)
        for column in ("model_gpu_ms", "sse_px_p95", "predicted_gpu_ms"):
            np.testing.assert_array_equal(half[column], small[column])
        assert (half["model_gpu_ms"] != whole["model_gpu_ms"]).any()


@pytest.mark.parametrize("name", AIMED)
def test_the_budget_is_not_claimed_above_it(name: str) -> None:
    """Up to an aim of 1 it is; beyond, the policy means to exceed it."""
    spec = parse_policy(name)
    assert claims_of(vary_policy(spec, {"aim": 1.0}).make()).budget
    assert claims_of(vary_policy(spec, {"aim": 0.3}).make()).budget
    assert not claims_of(vary_policy(spec, {"aim": 1.01}).make()).budget


def test_every_policy_that_claims_the_budget_has_an_aim() -> None:
    """Else it could not be brought to another operating point."""
    claiming = {name for name in TURNED if claims_of(parse_policy(name).make()).budget}
    assert claiming == set(AIMED)


def test_distances_scale_together(run: Run) -> None:
    """A scale of 2 is twice both distances."""
    scene = small_scenes()[0]
    scaled = run(parse_policy("static-distance:near_m=5,far_m=30,scale=2"), scene, 6.0)
    typed = run(parse_policy("static-distance:near_m=10,far_m=60"), scene, 6.0)
    np.testing.assert_array_equal(scaled["model_gpu_ms"], typed["model_gpu_ms"])


def test_a_wrapped_policy_is_turned_from_outside(run: Run) -> None:
    """`setting` is the value of the inner knob, with the inner range."""
    outer = parse_policy("predictive:policy=static-screen,setting=3")
    assert knob_of(outer) == replace(knob("static-screen"), name="setting")
    scene = small_scenes()[0]
    inner = run(parse_policy("predictive:policy=static-screen+bias=3"), scene, 6.0)
    np.testing.assert_array_equal(run(outer, scene, 6.0)["model_gpu_ms"], inner["model_gpu_ms"])


def test_a_wrapped_policy_without_a_knob_has_no_setting() -> None:
    """It has no knob either, and a setting is refused in a line."""
    assert knob_of(parse_policy("predictive:policy=full")) is None
    with pytest.raises(InputError, match=r"^predictive: expected no setting, as full has no knob"):
        parse_policy("predictive:policy=full,setting=2").make()
