"""Test the regulation of a tolerance by triangles and by late times."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.scene import Scene
from lodbench.policies.controllers.hoppe import Hoppe, critical_gain
from lodbench.policies.frame_times import Completed
from lodbench.policies.view import View
from lodbench.sim.replay import ReplayOptions, replay

Make = Callable[..., Any]
WIDE: dict[str, Any] = {"min_px": 1e-9, "max_px": 1e9}


@pytest.fixture(scope="module")
def slope(make_scene: Make, make_levels: Make) -> Callable[[float], Scene]:
    """Return a function that builds one object whose triangles go as error^(-elasticity)."""

    def build(elasticity: float) -> Scene:
        triangles = 1e5 * np.exp(-0.002 * np.arange(4600))  # 100,000 to 10
        error_m = 1e-3 * (triangles / 1e5) ** (-1.0 / elasticity)
        levels = make_levels([triangles], error_m=[error_m])
        return make_scene([(0.0, 0.0, -10.0)], levels=levels)

    return build


def regulate(
    scene: Scene, make_view: Make, frames: int, *, start: float, target: float, **params: Any
) -> list[float]:
    """Return the triangles of each frame, starting from a tolerance that draws `start`."""
    levels = scene.types.levels
    counts = levels.counts[:, 2]
    view = make_view(scene)
    px_per_m = view.camera.focal_px / view.nearest_m[0]
    start_px = float(levels.error_m[np.argmin(np.abs(counts - start))] * px_per_m)
    policy = Hoppe(triangles=target, start_px=start_px * 1.0001, **WIDE, **params)
    policy.reset(scene, 10.0)
    return [float(counts[int(policy.select(view).detail[0])]) for _ in range(frames)]


def test_elasticity_one_half_is_monotone(slope: Callable[..., Scene], make_view: Make) -> None:
    """With p = 1/2 the log-error halves each frame: 1000, 707, 595, 545 towards 500."""
    counts = regulate(slope(0.5), make_view, 12, start=1000.0, target=500.0)
    assert counts[:4] == pytest.approx([1000.0, 707.1, 594.6, 545.3], rel=0.01)
    assert all(a >= b for a, b in pairwise(counts))


def test_elasticity_one_is_on_target_at_once(slope: Callable[..., Scene], make_view: Make) -> None:
    """With p = 1 the second frame draws what was asked for."""
    counts = regulate(slope(1.0), make_view, 6, start=1000.0, target=500.0)
    assert counts[1:] == pytest.approx([500.0] * 5, rel=0.01)


def test_elasticity_three_halves_rings_and_settles(
    slope: Callable[..., Scene], make_view: Make
) -> None:
    """With p = 3/2 the error changes sign and halves: 1000, 354, 595, 459."""
    counts = regulate(slope(1.5), make_view, 12, start=1000.0, target=500.0)
    assert counts[:4] == pytest.approx([1000.0, 353.6, 594.6, 458.5], rel=0.01)
    assert counts[-1] == pytest.approx(500.0, rel=0.01)


def test_elasticity_two_never_settles(slope: Callable[..., Scene], make_view: Make) -> None:
    """With p = 2 the counts alternate between 1000 and 250; half the gain is on target at once."""
    counts = regulate(slope(2.0), make_view, 10, start=1000.0, target=500.0)
    assert counts[::2] == pytest.approx([1000.0] * 5, rel=0.02)
    assert counts[1::2] == pytest.approx([250.0] * 5, rel=0.02)
    damped = regulate(slope(2.0), make_view, 10, start=1000.0, target=500.0, gain=0.5)
    assert damped[1:] == pytest.approx([500.0] * 9, rel=0.01)


def test_an_empty_frame_leaves_the_tolerance(slope: Callable[..., Scene], make_view: Make) -> None:
    """Looking where nothing is does not ask for infinite detail on looking back."""
    scene = slope(1.0)
    policy = Hoppe(triangles=500.0, **WIDE)
    policy.reset(scene, 10.0)
    view = make_view(scene)
    rested = [policy.select(view).detail[0] for _ in range(3)][-1]
    none = View(view.state, view.ids[:0], view.xyz_m[:, :0])
    for _ in range(5):
        assert len(policy.select(none).ids) == 0
    assert policy.select(view).detail[0] == rested


def steer(scene: Scene, make_view: Make, delay: int, gain: float | None) -> np.ndarray:
    """Return log errors of work ``K / tau`` whose times are `delay` frames late."""
    policy = Hoppe(gain=gain, start_px=1.01, target=1.0, **WIDE)
    policy.reset(scene, 10.0)
    base = make_view(scene)
    times_ms = np.zeros((300, 4))
    for frame in range(300):
        completed = Completed(times_ms, max(frame - delay, 0))
        state = replace(base.state, frame=frame, completed=completed)
        policy.select(View(state, base.ids, base.xyz_m))
        # Enough of a difference from frame to frame that no report repeats the last one.
        tau = policy._tolerance_px  # pyright: ignore[reportPrivateUsage] - levels are too coarse
        times_ms[frame] = 10.0 / tau * (1.0 + 1e-9 * (frame % 7))
    return np.log(times_ms[:, 2] / 10.0)


@pytest.mark.parametrize(
    ("delay", "critical"), [(0, 2.0), (1, 1.0), (2, 0.618), (3, 0.445), (4, 0.347), (5, 0.285)]
)
def test_late_times_bound_the_gain(
    slope: Callable[..., Scene], make_view: Make, delay: int, critical: float
) -> None:
    """3 % below the law's gain errors die out, 3 % above they grow; the default gain is half."""
    assert critical_gain(delay) == pytest.approx(critical, abs=5e-4)

    def grows(gain: float | None) -> bool:
        error = np.abs(steer(slope(1.0), make_view, delay, gain))
        return bool(error[200:].max() > min(error[50:150].max(), 1.0))

    assert not grows(0.97 * critical)
    assert grows(1.03 * critical)
    assert np.abs(steer(slope(1.0), make_view, delay, None)[200:]).max() < 1e-6


def test_gain_one_oscillates_in_the_pipeline_and_the_default_settles(
    slope: Callable[..., Scene], make_hardware: Make, make_trace: Make
) -> None:
    """With 2 frames in flight and timers 2 frames late (k = 3) Hoppe's own gain swings for ever."""
    hardware = make_hardware({"triangles": 1e-3}, base_ms=0.0, cpu_base_ms=0.0)
    options = ReplayOptions(budget_ms=10.0, frames=200, measurement_delay=2)
    spread: list[float] = []
    for gain in (1.0, None):
        policy = Hoppe(gain=gain, target=1.0, start_px=0.06, min_px=1e-3, rest=False)
        log = replay(policy, slope(1.0), make_trace(), hardware, options, name="hoppe")
        late = np.log(log["gpu_ms"][100:] / 10.0)
        spread.append(float(np.abs(late).max()))
    print(f"largest log-error: gain 1 {spread[0]:.2f}, by the delay {spread[1]:.4f}")
    assert spread[0] > 1.0
    assert spread[1] < 0.02


def test_at_rest_it_ends_where_the_printed_rule_goes_to_and_fro(
    slope: Callable[..., Scene], make_view: Make
) -> None:
    """Elasticity 2: 1000 and 250 triangles by turns, but at rest 1000, 250, 500 and no more."""
    scene = slope(2.0)
    view = make_view(scene)
    still = View(replace(view.state, previous_camera=view.camera), view.ids, view.xyz_m)
    counts = scene.types.levels.counts[:, 2]
    start_px = float(scene.types.levels.error_m[np.argmin(np.abs(counts - 1000.0))])
    start_px *= 1.0001 * float(view.camera.focal_px / view.nearest_m[0])
    policy = Hoppe(triangles=500.0, start_px=start_px, **WIDE)
    policy.reset(scene, 10.0)
    drawn = [float(counts[int(policy.select(seen).detail[0])]) for seen in (view, *[still] * 20)]
    assert drawn[:3] == pytest.approx([1000.0, 250.0, 500.0], rel=0.02)
    assert drawn[2:] == pytest.approx([500.0] * 19, rel=0.02)
    assert len(set(drawn[10:])) == 1


@pytest.mark.parametrize("budget_ms", [0.1, 0.5, 1.0, 2.0, 3.0])
@pytest.mark.parametrize("continuous", [False, True])
def test_a_still_camera_comes_to_rest(
    make_scene: Make,
    make_levels: Make,
    make_hardware: Make,
    make_trace: Make,
    *,
    continuous: bool,
    budget_ms: float,
) -> None:
    """Three objects of steps that no tolerance makes the budget: nothing toggles in the end."""
    levels = make_levels([(3000.0, 1000.0, 300.0)], continuous=continuous)
    scene = make_scene([(x, 0.0, -z) for x, z in ((0, 5), (2, 9), (-3, 20))], levels=levels)
    hardware = make_hardware({"triangles": 5e-4}, base_ms=0.1)
    options = ReplayOptions(budget_ms=budget_ms, frames=200)
    log = replay(Hoppe(), scene, make_trace(), hardware, options, name="hoppe")
    assert not log["toggles"][100:].any()
    assert len(set(log["triangles"][100:])) == 1


def test_faulty_times_never_raise_detail(slope: Callable[..., Scene], make_view: Make) -> None:
    """Missing, zero and negative reports leave the level; a shorter time refines."""
    scene = slope(1.0)
    policy = Hoppe(target=1.0, start_px=0.1, min_px=1e-6)
    policy.reset(scene, 10.0)
    times_ms = [9.0]
    level = policy.select(make_view(scene, work_ms=times_ms)).detail[0]
    for fault in (np.nan, 0.0, -3.0):
        times_ms.append(fault)
        assert policy.select(make_view(scene, work_ms=times_ms)).detail[0] == level
    times_ms.append(8.0)
    assert policy.select(make_view(scene, work_ms=times_ms)).detail[0] < level


@pytest.mark.parametrize(
    "params",
    [
        {"triangles": 0.0},
        {"gain": -1.0},
        {"gain": np.nan},
        {"start_px": 0.01},
        {"target": 0.0},
        {"max_px": 0.5},
    ],
)
def test_senseless_parameters_are_refused(
    slope: Callable[..., Scene], params: dict[str, Any]
) -> None:
    """A parameter out of its range is bad input."""
    with pytest.raises(InputError, match=f"hoppe: expected .*{next(iter(params))}.*, got"):
        Hoppe(**params).reset(slope(1.0), 10.0)
