"""Test Unreal's dynamic resolution, applied to level bias and to render scale."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.scene import Scene
from lodbench.policies.controllers.unreal_dynamic import UnrealDynamic, suggest_fraction
from lodbench.policies.frame_times import Completed
from lodbench.policies.selection import Selection, find_violation
from lodbench.policies.thresholds.static_screen import StaticScreen
from lodbench.policies.view import View
from lodbench.sim.replay import ReplayOptions, replay

Make = Callable[..., Any]


@pytest.mark.parametrize(
    ("time_ms", "fraction"),
    [(20, 1.2241), (25, 1.0949), (30, 0.9995), (35, 0.9254), (40, 0.8656), (60, 0.7068)],
)
def test_suggestions_before_clamping(time_ms: float, fraction: float) -> None:
    """The oracle of the notes, section 2.1: 33.3 ms with 10 % headroom, fraction 1."""
    assert suggest_fraction(33.3 * 0.9, time_ms, 1.0) == pytest.approx(fraction, abs=5e-5)


@pytest.fixture(scope="module")
def rows(make_scene: Make, make_levels: Make) -> Scene:
    """Return objects ahead at many distances, of six levels."""
    depth_m = 4.0 * 2.0 ** np.linspace(0.0, 3.0, 65)
    position_m = np.column_stack((np.zeros(65), np.zeros(65), -depth_m))
    return make_scene(position_m, levels=make_levels([[32.0, 16.0, 8.0, 4.0, 2.0, 1.0]]))


class Driven:
    """A policy that renders at scale, fed with times; its fraction is that scale."""

    def __init__(self, scene: Scene, make_view: Make, delay: int = 0, **params: Any) -> None:
        chosen: dict[str, Any] = {"apply": "render-scale", "min_fraction": 0.1, **params}
        self.policy = UnrealDynamic(**chosen)
        self.policy.reset(scene, 33.3)
        self.base = make_view(scene)
        self.times_ms = np.full((5000, 4), np.nan)
        self.frame, self.delay = 0, delay

    def step(self, time_ms: float) -> float:
        """Return the fraction of the next frame, and note how long it took."""
        completed = Completed(self.times_ms, max(self.frame - self.delay, 0))
        state = replace(self.base.state, frame=self.frame, completed=completed)
        fraction = self.policy.select(View(state, self.base.ids, self.base.xyz_m)).render_scale
        self.times_ms[self.frame] = time_ms
        self.frame += 1
        return fraction

    def run(self, time_of: Callable[[float], float], frames: int) -> list[float]:
        """Return the fractions of frames whose times follow from them."""
        fractions: list[float] = []
        fraction = 1.0
        for _ in range(frames):
            # A little different each time, so that no report repeats the last one.
            fraction = self.step(time_of(fraction) * (1.0 + 1e-9 * (self.frame % 5)))
            fractions.append(fraction)
            self.times_ms[self.frame - 1] = time_of(fraction) * (1.0 + 1e-9 * (self.frame % 5))
        return fractions


def test_deadbeat_where_time_goes_by_the_square(rows: Scene, make_view: Make) -> None:
    """32 ms at full size (no panic): after 8 frames the fraction is sqrt(29.97 / 32) and rests."""
    fractions = Driven(rows, make_view).run(lambda f: 32.0 * f * f, 40)
    expected = math.sqrt(29.97 / 32.0)
    assert fractions[:8] == [1.0] * 8
    assert fractions[8:] == pytest.approx([expected] * 32, abs=1e-6)


def test_panic_after_two_frames_over_budget(rows: Scene, make_view: Make) -> None:
    """60 ms at full size: as soon as two reports are there the fraction is 0.7068."""
    fractions = Driven(rows, make_view).run(lambda f: 60.0 * f * f, 20)
    assert fractions[:2] == [1.0, 1.0]
    assert fractions[2:] == pytest.approx([0.7068] * 18, abs=5e-5)


def test_late_reports_are_judged_at_their_own_fraction(rows: Scene, make_view: Make) -> None:
    """Three frames late, frames drawn before the change panic again, to the same fraction."""
    fractions = Driven(rows, make_view, delay=3).run(lambda f: 60.0 * f * f, 30)
    assert fractions[:5] == [1.0] * 5
    assert fractions[5:] == pytest.approx([0.7068] * 25, abs=5e-5)


def test_one_slow_frame_is_no_panic(rows: Scene, make_view: Make) -> None:
    """A single frame over budget among good ones changes nothing at once."""
    driven = Driven(rows, make_view)
    times_ms = [29.9, 30.0, 29.9, 50.0, 30.0, 29.9, 30.0]
    assert [driven.step(time_ms) for time_ms in times_ms] == [1.0] * 7


def test_partly_scalable_cost_converges_without_swinging(rows: Scene, make_view: Make) -> None:
    """With 70 % of 33 ms scalable the time falls to the target from above, never below."""

    def time_of(fraction: float) -> float:
        return 33.0 * (0.3 + 0.7 * fraction * fraction)

    fractions = Driven(rows, make_view, threshold=0.0).run(time_of, 600)
    assert all(later <= earlier + 1e-9 for earlier, later in pairwise(fractions))
    assert time_of(fractions[-1]) == pytest.approx(29.97, rel=2e-3)
    assert time_of(fractions[-1]) >= 29.97 * (1.0 - 1e-6)


def test_increase_goes_nine_tenths_of_the_way(rows: Scene, make_view: Make) -> None:
    """From 0.5 with time to spare the next fraction is 0.5 + 0.9 (wanted - 0.5)."""
    driven = Driven(rows, make_view, max_fraction=1.0, history=1)
    driven.run(lambda _: 120.0, 3)  # panic: sqrt(29.97 / 120) = 0.49975
    low = math.sqrt(29.97 / 120.0)
    fractions = driven.run(lambda _: 20.0, 9)
    wanted = math.sqrt(29.97 / 20.0) * low
    assert fractions[-1] == pytest.approx(low + 0.9 * (wanted - low), abs=1e-6)


def test_small_changes_are_ignored(rows: Scene, make_view: Make) -> None:
    """1 % too large is left alone, 3 % is not."""
    for over, changes in ((1.01, False), (1.03, True)):
        time_ms = 29.97 * over * over
        fractions = Driven(rows, make_view).run(lambda f, t=time_ms: t * f * f, 30)
        assert (fractions[-1] != 1.0) == changes


def test_weights_fall_by_a_tenth_a_frame(rows: Scene, make_view: Make) -> None:
    """Suggestions of 8 frames, newest first, have the weights 1, 0.9, 0.81, ..."""
    times_ms = [33.0, 32.0, 31.5, 32.5, 33.1, 32.2, 31.9, 32.7]
    driven = Driven(rows, make_view)
    for time_ms in times_ms:
        driven.step(time_ms)
    suggestions = np.sqrt(29.97 / np.array(times_ms[::-1]))
    weights = 0.9 ** np.arange(8)
    assert driven.step(1.0) == pytest.approx(float(suggestions @ weights / weights.sum()))


def test_bias_multiplies_heights(rows: Scene, make_view: Make) -> None:
    """After a panic to 0.5 the levels are those of static-screen with that bias."""
    policy = UnrealDynamic()
    policy.reset(rows, 33.3)
    assert policy.select(make_view(rows)).detail.tolist() == biased(rows, make_view, 1.0)
    selection = policy.select(make_view(rows, work_ms=[150.0, 151.0]))
    assert selection.detail.tolist() == biased(rows, make_view, 0.5)
    assert selection.render_scale == 1.0


def biased(scene: Scene, make_view: Make, bias: float) -> list[float]:
    """Return the levels of static-screen without hysteresis."""
    static = StaticScreen(bias=bias, hysteresis=0.0)
    static.reset(scene, 33.3)
    return static.select(make_view(scene)).detail.tolist()


def test_faulty_times_never_raise_detail(rows: Scene, make_view: Make) -> None:
    """Missing, zero and stuck reports after a panic leave the fraction where it is."""
    for fault in (np.nan, 0.0, -1.0, 12.0):
        driven = Driven(rows, make_view)
        for time_ms in (60.0, 61.0, 12.0 if fault == 12.0 else fault):
            driven.step(time_ms)
        low = driven.step(fault)
        assert low < 0.75
        for _ in range(6):
            assert driven.step(fault) <= low + 1e-12


def test_render_scale_saves_pixels_and_costs_benefit(
    rows: Scene, make_hardware: Make, make_trace: Make
) -> None:
    """At half size in both directions a quarter of the pixels is paid for, and of benefit had."""
    linear = {"triangles": 1e-3, "shaded_samples": 1e-3, "framebuffer_pixels": 1e-3}
    hardware = make_hardware(linear, base_ms=0.0)
    options = ReplayOptions(budget_ms=1.0, frames=2, bound_every=1)

    def run(fraction: float) -> Any:
        policy = UnrealDynamic(
            "render-scale", min_fraction=fraction, max_fraction=fraction, hysteresis=0.0
        )
        return replay(policy, rows, make_trace(), hardware, options, name="unreal")

    full, half = run(1.0), run(0.5)
    assert half["triangles"][0] == full["triangles"][0]
    assert half["shaded_samples"][0] == pytest.approx(0.25 * full["shaded_samples"][0])
    pixels_ms = full["model_gpu_ms"][0] - 1e-3 * full["triangles"][0]
    assert pixels_ms == pytest.approx(1e-3 * (full["shaded_samples"][0] + 100 * 100))
    saved_ms = full["model_gpu_ms"][0] - half["model_gpu_ms"][0]
    assert saved_ms == pytest.approx(0.75 * pixels_ms)
    assert half["benefit"][0] == pytest.approx(0.25 * full["benefit"][0])
    assert half["degradation"][0] == pytest.approx(4.0 * full["degradation"][0])
    assert full["benefit_bound"][0] >= full["benefit"][0]
    assert np.isnan(half["benefit_bound"]).all()


@pytest.mark.parametrize("scale", [0.0, 1e-300, 1.5, math.nan, "half"])
def test_a_render_scale_out_of_range_is_a_violation(
    rows: Scene, make_view: Make, scale: Any
) -> None:
    """A picture has between none and all of the window's width, and the simulator says so."""
    view = make_view(rows)
    selection = Selection(view.ids, np.zeros(len(view)), render_scale=scale)
    violation = find_violation(selection, view.ids, rows)
    assert violation is not None
    assert violation.startswith("render_scale: expected a number from 0.0010 to 1, got ")


@pytest.mark.parametrize(
    "params",
    [
        {"apply": "resolution"},
        {"headroom": 1.0},
        {"min_fraction": 0.0},
        {"max_fraction": 1.5},
        {"history": 0},
        {"weight": 0.0},
        {"increase": 1.5},
        {"threshold": -0.1},
        {"threshold": np.nan},
    ],
)
def test_senseless_parameters_are_refused(rows: Scene, params: dict[str, Any]) -> None:
    """A parameter out of its range is bad input."""
    with pytest.raises(InputError, match=f"unreal-dynamic: expected .*{next(iter(params))}.*, got"):
        UnrealDynamic(**params).reset(rows, 10.0)
