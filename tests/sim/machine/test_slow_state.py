"""The slow state of a machine: a function of time, with the spread and the memory it is given."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.base.arrays import FloatArray
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.machine.slow_state import SlowState
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate

Make = Callable[..., HardwareProfile]


def factors(residual: Residual, seed: int, times_s: FloatArray) -> FloatArray:
    """Return the factors at some times."""
    state = SlowState(residual, np.random.SeedSequence(seed))
    return np.array([state.at(round(time_s * 1e9)) for time_s in times_s.tolist()])


def test_the_state_has_its_spread_and_forgets_in_its_time():
    """Over 4,000 seeds: mean 1, log-sd .2, and correlations exp(-t / 2 s) at 0.5, 2 and 6 s."""
    residual = Residual(slow_scale=0.2, slow_time_s=2.0)
    lags = np.array([0.0, 0.5, 2.0, 6.0])
    found = np.array([factors(residual, seed, lags) for seed in range(4000)])
    assert found.mean(axis=0) == pytest.approx(np.ones(4), abs=0.012)
    logs = np.log(found)
    assert logs.std(axis=0) == pytest.approx(np.full(4, 0.2), rel=0.04)
    correlation = np.corrcoef(logs.T)[0]
    assert correlation == pytest.approx(np.exp(-lags / 2.0), abs=0.04)


def test_the_state_is_a_function_of_time_alone():
    """Asked at 1,000 times, or at every tenth of them, it is the same at those, block by block."""
    residual = Residual(slow_scale=0.1, slow_time_s=0.5)
    times_s = np.sort(np.random.default_rng(1).uniform(0.0, 60.0, 1000))
    assert (
        factors(residual, 7, times_s)[::10].tolist() == factors(residual, 7, times_s[::10]).tolist()
    )
    assert (
        factors(residual, 8, times_s[::10]).tolist() != factors(residual, 7, times_s[::10]).tolist()
    )


def test_the_state_moves_little_from_frame_to_frame():
    """In 1/100 s of 10 s, an Ornstein-Uhlenbeck path moves by sqrt(2 · .001) of its deviation."""
    residual = Residual(slow_scale=0.1, slow_time_s=10.0)
    steps = np.diff(np.log(factors(residual, 3, np.arange(0.0, 300.0, 0.625))))
    # At the grid's own points, 10 s / 16 apart, where nothing is interpolated.
    assert steps.std() == pytest.approx(0.1 * np.sqrt(2.0 * (1.0 - np.exp(-1 / 16))), rel=0.1)
    fine = np.diff(np.log(factors(residual, 3, np.arange(0.0, 300.0, 0.01))))
    assert np.abs(fine).max() < 0.01


@pytest.fixture
def street(
    make_scene: Callable[..., Scene], make_levels: Callable[..., LevelTable]
) -> tuple[Scene, CameraTrace]:
    """Twenty objects of two levels, and a walk of six seconds among them."""
    rng = np.random.default_rng(5)
    centers = np.column_stack([rng.uniform(-20.0, 20.0, (20, 2)), np.ones(20)])
    scene = make_scene(centers, kind=np.zeros(20, dtype=int), levels=make_levels([(4000, 300)]))
    return scene, generate("walk", duration_s=6.0, extent_m=20.0, seed=1)


def run(
    street: tuple[Scene, CameraTrace], hardware: HardwareProfile, policy: str, seed: int = 4
) -> FrameLog:
    """Return the log of a replay."""
    options = ReplayOptions(budget_ms=16.0, seed=seed)
    return replay(parse_policy(policy).make(), *street, hardware, options, name=policy)


def noise_of(log: FrameLog) -> FloatArray:
    """Return what times of the GPU are of those of its cost model."""
    return np.asarray(log["gpu_ms"] / log["model_gpu_ms"])


def test_policies_of_one_seed_meet_one_state(
    street: tuple[Scene, CameraTrace], make_hardware: Make
):
    """Full detail takes many times as long a frame as the coarsest, and both see the same state."""
    residual = Residual(slow_scale=0.15, slow_time_s=1.0)
    hardware = make_hardware({"triangles": 1e-3}, residual=residual)
    full, coarse = (run(street, hardware, name) for name in ("full", "static-screen:bias=0.001"))
    assert len(coarse) > 3 * len(full)
    state = SlowState(residual, np.random.SeedSequence(4).spawn(3)[0].spawn(2)[0])
    known = [state.at(int(ns)) for ns in coarse["input_ns"]]
    assert noise_of(coarse) == pytest.approx(np.array(known), rel=1e-9)
    assert noise_of(full) == pytest.approx(
        np.interp(full["input_ns"], coarse["input_ns"], noise_of(coarse)), rel=0.02
    )


def test_what_is_added_to_noise_leaves_the_rest_of_it(
    street: tuple[Scene, CameraTrace], make_hardware: Make
):
    """Frame k has the k-th factor of its seed, times the state of its time, times its spike."""
    fast = Residual("student-t", 0.05, dof=4.0, correlation=0.5)
    parts = {"slow_scale": 0.1, "slow_time_s": 1.0}, {"spike_share": 0.2, "spike_scale": 0.5}
    seed = np.random.SeedSequence(4).spawn(3)[0]
    drawn = fast.factors(np.random.default_rng(seed), 1024)
    of_state, of_spikes = seed.spawn(2)
    for more in ({}, *parts, parts[0] | parts[1]):
        residual = Residual("student-t", 0.05, dof=4.0, correlation=0.5, **more)
        log = run(street, make_hardware({"triangles": 1e-3}, residual=residual), "full")
        expected = drawn[: len(log)].copy()
        if "spike_share" in more:
            expected *= residual.spikes(np.random.default_rng(of_spikes), 1024)[: len(log)]
        if "slow_scale" in more:
            state = SlowState(residual, of_state)
            expected *= [state.at(int(ns)) for ns in log["input_ns"]]
        assert noise_of(log) == pytest.approx(expected, rel=1e-12)


def test_the_processor_has_a_state_of_its_own(
    street: tuple[Scene, CameraTrace], make_hardware: Make
):
    """0.5 ms of CPU with a slow state and spikes vary, beside a GPU that does not."""
    hardware = replace(
        make_hardware(), cpu_residual=Residual(slow_scale=0.1, spike_share=0.1, spike_scale=1.0)
    )
    log = run(street, hardware, "full")
    assert (noise_of(log) == 1.0).all()
    cpu = log["cpu_ms"] / 0.5
    assert np.median(cpu) == pytest.approx(1.0, abs=0.2)
    assert cpu.std() > 0.1
    assert run(street, hardware, "full").counts.tobytes() == log.counts.tobytes()
