"""Laws that every replay keeps: books balance, noise is shared, a second replay is the first."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.protocol import Policy
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.policies.thresholds.static_screen import StaticScreen
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.generators.generate import generate


@pytest.fixture(scope="module")
def walked(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_hardware: Callable[..., HardwareProfile],
) -> Callable[..., FrameLog]:
    """Return a function that replays 400 frames of a walk among 300 objects, noise and all."""
    generator, n = np.random.default_rng(4), 300
    scene = make_scene(
        np.column_stack([generator.uniform(-60, 60, (n, 2)), np.ones(n)]),
        kind=generator.integers(0, 2, n),
        radius_m=[1.0, 0.5],
        scale=generator.uniform(0.5, 2.0, n),
        importance=generator.uniform(0.0, 2.0, n),
        levels=make_levels([(2000, 700, 100), (900, 300, 60)]),
    )
    hardware = make_hardware(
        {"triangles": 5e-5, "draw_calls": 2e-3, "shaded_samples": 1e-6},
        cpu={"draw_calls": 1e-3, "objects_visited": 1e-4},
        residual=Residual("student-t", 0.05),
        mode="vsync",
    )
    trace = generate("walk", extent_m=80.0, duration_s=30.0, seed=2)

    def walk(policy: Policy, seed: int = 7) -> FrameLog:
        options = ReplayOptions(budget_ms=8.0, frames=400, seed=seed)
        return replay(policy, scene, trace, hardware, options, name="walked")

    return walk


Walk = Callable[..., FrameLog]
POLICIES = [Full, StaticDistance, StaticScreen, Feedback]


@pytest.mark.parametrize("cls", POLICIES)
def test_books_balance_in_every_frame(walked: Walk, cls: Callable[[], Policy]) -> None:
    """Laws that hold whatever a policy does: sums, bounds, and times that agree with costs."""
    log = walked(cls())
    assert (log["drawn"] + log["missing"] == log["visible"]).all()
    assert (log["reversals"] <= log["toggles"]).all()
    assert (log["toggles"] <= log["drawn"]).all()
    assert (log["draw_calls"] == log["drawn"]).all()
    assert (log["state_changes"] <= np.minimum(log["drawn"], 2)).all()
    assert (log["benefit"] <= log["full_benefit"] * (1 + 1e-12)).all()
    assert (log["degradation"] >= log["full_degradation"] * (1 - 1e-12)).all()
    assert (log["model_gpu_ms"] <= log["full_gpu_ms"] * (1 + 1e-12)).all()
    assert (log["sse_px_p95"] <= log["sse_px_max"]).all()
    beyond_px = np.maximum(log["sse_px_max"] - log.header.visible_px, 0.0)
    assert (log["visible_error_area_px"] <= beyond_px * (1 + 1e-12)).all()
    assert (log["visible_pops"] <= log["toggles"]).all()
    assert (log["select_ms"] <= log["cpu_ms"]).all()
    cpu_ns, gpu_ns = log["cpu_end_ns"] - log["input_ns"], log["gpu_end_ns"] - log["gpu_start_ns"]
    assert np.abs(cpu_ns - log["cpu_ms"] * 1e6).max() <= 0.5
    assert np.abs(gpu_ns - log["gpu_ms"] * 1e6).max() <= 0.5
    expected = 1.0 + 5e-5 * log["triangles"] + 2e-3 * log["draw_calls"]
    assert log["model_gpu_ms"] == pytest.approx(expected + 1e-6 * log["shaded_samples"])


def test_full_detail_is_full_in_every_respect(walked: Walk) -> None:
    """Under `full` benefit, degradation and cost equal their full values, and nothing errs."""
    log = walked(Full())
    assert (log["benefit"] == log["full_benefit"]).all()
    assert (log["degradation"] == log["full_degradation"]).all()
    assert (log["model_gpu_ms"] == log["full_gpu_ms"]).all()
    for name in ("sse_px_p95", "sse_px_max", "toggles", "visible_pops", "missing"):
        assert not log[name].any()


def test_noise_is_the_same_under_every_policy(walked: Walk) -> None:
    """Frame k is as unlucky under one policy as under another; another seed has other luck."""
    logs = [walked(cls()) for cls in POLICIES]
    factors = [log["gpu_ms"] / log["model_gpu_ms"] for log in logs]
    for factor in factors[1:]:
        assert factor == pytest.approx(factors[0])
    other = walked(Full(), seed=8)
    assert np.abs(other["gpu_ms"] / other["model_gpu_ms"] - factors[0]).max() > 0.01


@pytest.mark.parametrize("cls", POLICIES)
def test_a_second_replay_with_the_same_policy_equals_the_first(
    walked: Walk, cls: Callable[[], Policy]
) -> None:
    """``reset`` forgets everything: the same object replays to the same bytes."""
    policy = cls()
    first, second = walked(policy), walked(policy)
    assert first.times_ns.tobytes() == second.times_ns.tobytes()
    assert first.counts.tobytes() == second.counts.tobytes()
