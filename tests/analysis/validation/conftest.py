"""A small world whose truth is known: simulated replays stand for recordings."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.study.compare import CompareSettings
from lodbench.analysis.validation.recorded_frames import Measured
from lodbench.analysis.validation.replicates import Simulation, simulate_all
from lodbench.base.predictors import GPU_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile, Posterior
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import UNLOGGED, FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

LABELS = ("full", "static-screen", "feedback", "funkhouser")
BUDGET_MS = 20.0
_COSTS = {"triangles": 1e-3, "draw_calls": 1e-2}
_DRAWS = 64


def counts_of(log: FrameLog) -> dict[str, np.ndarray]:
    """Return what a frame log says was drawn."""
    return {name: log[name] for name in GPU_PREDICTORS if name not in UNLOGGED}


@pytest.fixture(scope="session")
def lane(make_levels: Callable[..., object], make_scene: Callable[..., Scene]) -> Scene:
    """Return sixty objects along a lane."""
    rng = np.random.default_rng(7)
    position_m = np.column_stack(
        (rng.uniform(-8.0, 8.0, 60), np.zeros(60), -rng.uniform(3.0, 60.0, 60))
    )
    levels = make_levels(((1000.0, 500.0, 250.0, 120.0, 60.0),))
    return make_scene(position_m, levels=levels)


@pytest.fixture(scope="session")
def walk(make_trace: Callable[..., CameraTrace]) -> CameraTrace:
    """Return two seconds along the lane."""
    return make_trace(((0.0, 0.0, 0.0), (0.0, 0.0, -6.0), (1.0, 0.0, -12.0)))


@pytest.fixture(scope="session")
def make_machine(make_hardware: Callable[..., HardwareProfile]) -> Callable[..., HardwareProfile]:
    """Return a maker of profiles whose draws of the costs are so many times those of the mean."""

    def make(
        factor: float = 1.0, *, spread: float = 0.05, noise: float = 0.05, in_flight: int = 1
    ) -> HardwareProfile:
        model = CostModel.of(1.0, _COSTS)
        scale = factor * np.exp(spread * np.random.default_rng(3).standard_normal(_DRAWS))
        residual = Residual("gaussian", noise, correlation=0.5)
        made = make_hardware(_COSTS, cpu_base_ms=0.0, frames_in_flight=in_flight, residual=residual)
        posterior = Posterior(scale, scale[:, None] * model.linear_ms, np.full(_DRAWS, noise))
        return replace(made, posterior=posterior)

    return make


@pytest.fixture(scope="session")
def simulated(lane: Scene, walk: CameraTrace) -> Callable[..., Simulation]:
    """Return what simulates the policies along the lane."""

    def run(
        hardware: HardwareProfile,
        labels: Sequence[str] = LABELS,
        replicates: int = 40,
        seed: int = 0,
        budget_ms: float = BUDGET_MS,
    ) -> Simulation:
        options = ReplayOptions(budget_ms=budget_ms, seed=seed)
        settings = CompareSettings(workers=1, warmup_s=0.2)
        return simulate_all(labels, lane, walk, hardware, options, settings, replicates)

    return run


@pytest.fixture(scope="session")
def simulation(
    simulated: Callable[..., Simulation], make_machine: Callable[..., HardwareProfile]
) -> Simulation:
    """Simulate all policies under the profile, as often as a validation does."""
    return simulated(make_machine())


@pytest.fixture(scope="session")
def recorded(lane: Scene, walk: CameraTrace) -> Callable[..., dict[str, tuple[Measured, ...]]]:
    """Return what records the policies twice, under draws and seeds that no replicate has."""

    def record(
        hardware: HardwareProfile,
        labels: Sequence[str] = LABELS,
        draws: tuple[int | None, ...] = (17, 17),
        seed: int = 9_000,
        budget_ms: float = BUDGET_MS,
    ) -> dict[str, tuple[Measured, ...]]:
        found: dict[str, tuple[Measured, ...]] = {}
        for label in labels:
            options = [
                ReplayOptions(budget_ms=budget_ms, seed=seed + at, draw=draw)
                for at, draw in enumerate(draws)
            ]
            logs = [
                replay(parse_policy(label).make(), lane, walk, hardware, chosen, name=label)
                for chosen in options
            ]
            found[label] = tuple(Measured(log, counts_of(log)) for log in logs)
        return found

    return record
