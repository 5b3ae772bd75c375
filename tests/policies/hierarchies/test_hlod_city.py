"""The thesis' claims on a city of 2,297 nodes: few toggles, bounded memory, good estimates."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.tree import Tree
from lodbench.policies.registry import parse_policy
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

WARMUP = 200  # frames in which the roots' share finds its level
WALK_M_S = 1.4
USED_MS = 22.0  # of what policies are told where they are compared
SEEDS = (0, 1)  # of noise


@pytest.fixture(scope="module")
def run(
    old_machine: HardwareProfile, make_street_trace: Callable[..., CameraTrace]
) -> Callable[..., FrameLog]:
    """Return a function that replays a policy along the street, once for the same arguments.

    The disk and memory are a large fast machine's unless a bound is given; times scatter by 3 %
    where a seed is given.
    """
    logs: dict[Any, FrameLog] = {}

    def replayed(
        policy: str,
        scene: Scene,
        *,
        speed_m_s: float = WALK_M_S,
        frames: int = 500,
        memory_bytes: float | None = None,
        seed: int | None = None,
        budget_ms: float = 30.0,
    ) -> FrameLog:
        key = (policy, scene.name, speed_m_s, frames, memory_bytes, seed, budget_ms)
        if key not in logs:
            machine = old_machine
            if memory_bytes is None:
                machine = replace(old_machine, memory_bytes=2e9, disk_bytes_per_s=1e9)
            if seed is not None:
                machine = replace(machine, gpu_residual=Residual("gaussian", scale=0.03))
            trace = make_street_trace(speed_m_s, 25.0)
            options = ReplayOptions(
                budget_ms=budget_ms, frames=frames, memory_bytes=memory_bytes, seed=seed or 0
            )
            made = parse_policy(policy).make()
            logs[key] = replay(made, scene, trace, machine, options, name=policy)
        return logs[key]

    return replayed


def _per_frame(log: FrameLog, column: str) -> float:
    return float(log[column][WARMUP:].mean())


def test_the_city_is_the_thesis_size(city: Scene) -> None:
    """114 roots, about 2,296 nodes, at most five levels, at the disk far more than in memory."""
    tree = Tree(city)
    assert len(city.roots) == 114
    assert abs(len(city) - 2_296) < 10
    assert int(tree.depth.max()) + 1 <= 5
    assert float(city.types.levels.bytes.sum()) > 4 * 2.5e8


def _at_equal_use(
    run: Callable[..., FrameLog], policy: str, scene: Scene, seed: int
) -> dict[str, float]:
    """Return what frames of a walk have on average where they take 22 ms, noise of 3 % included.

    The budget that the policy is told is changed in proportion until they do, to 4 %; what comes
    nearest counts.
    """
    columns = ("gpu_ms", "toggles", "reversals", "popping_px")
    budget_ms, found = USED_MS, {"gpu_ms": 0.0}
    for _ in range(4):
        log = run(policy, scene, frames=350, seed=seed, budget_ms=budget_ms)
        used_ms = _per_frame(log, "gpu_ms")
        if abs(used_ms - USED_MS) < abs(found["gpu_ms"] - USED_MS):
            found = {column: _per_frame(log, column) for column in columns}
        if abs(used_ms / USED_MS - 1.0) <= 0.04:
            break
        budget_ms *= min(max(USED_MS / used_ms, 0.8), 1.25)
    told = ", ".join(f"{column} {value:.4f}" for column, value in found.items())
    print(f"{scene.name}, seed {seed}, {policy}: {told}")
    return found


@pytest.mark.slow
def test_fewer_toggles_than_others_on_their_own_hierarchy(
    chains: Scene, run: Callable[..., FrameLog]
) -> None:
    """On objects with a chain of levels each, Funkhouser's and Maciel's flicker more, and undo it.

    That is the hierarchy of 1993 (thesis, section 5.1), where all choose among the same fronts.
    What they switch is smaller: in popping Funkhouser's is the calmer one here.
    """
    for seed in SEEDS:
        own = _at_equal_use(run, "hlod-hysteresis", chains, seed)
        for name in ("funkhouser", "maciel"):
            other = _at_equal_use(run, name, chains, seed)
            assert own["gpu_ms"] == pytest.approx(other["gpu_ms"], rel=0.08)
            assert 2.0 * own["toggles"] < other["toggles"]
            assert 5.0 * own["reversals"] < other["reversals"]


@pytest.mark.slow
def test_shared_time_toggles_less_than_lost_time(city: Scene, run: Callable[..., FrameLog]) -> None:
    """What a near wall cannot use steadies the others, at equal use of the budget."""
    for seed in SEEDS:
        shared = _at_equal_use(run, "hlod-hysteresis", city, seed)
        lost = _at_equal_use(run, "hlod-hysteresis:unused=lost", city, seed)
        assert shared["toggles"] < lost["toggles"]
        assert shared["popping_px"] < lost["popping_px"]
        assert shared["gpu_ms"] > 0.95 * lost["gpu_ms"]


def test_ten_times_the_speed_toggles_more(chains: Scene, run: Callable[..., FrameLog]) -> None:
    """As in the thesis: toggles follow the movement, and few are undone."""
    walk = run("hlod-hysteresis", chains, frames=350)
    drive = run("hlod-hysteresis", chains, frames=350, speed_m_s=14.0)
    assert _per_frame(drive, "toggles") > 3.0 * _per_frame(walk, "toggles")
    assert _per_frame(drive, "reversals") < 0.3 * _per_frame(drive, "toggles")


@pytest.mark.parametrize(("memory_bytes", "speed_m_s"), [(6e7, 14.0), (2.5e8, WALK_M_S)])
def test_memory_stays_under_its_bound_and_nothing_is_missing(
    city: Scene, run: Callable[..., FrameLog], memory_bytes: float, speed_m_s: float
) -> None:
    """In every frame; the replay itself checks that what is drawn is a front and in memory."""
    log = run("hlod-hysteresis", city, speed_m_s=speed_m_s, frames=700, memory_bytes=memory_bytes)
    memory = log["memory_bytes"]
    assert log.header.memory_bound_bytes == memory_bytes
    assert 0.9 < memory.max() / memory_bytes <= 1.0
    assert (log["missing"] == 0).all()
    read = np.cumsum(log["loaded_bytes"])
    assert memory[0] == read[0]
    assert (read - memory >= 0).all()


def test_two_replays_are_the_same(
    city: Scene, old_machine: HardwareProfile, make_street_trace: Callable[..., CameraTrace]
) -> None:
    """Loader included, the same arguments give the same bytes."""
    logs = [
        replay(
            parse_policy("hlod-hysteresis:all_children=on").make(),
            city,
            make_street_trace(14.0, 2.0),
            old_machine,
            ReplayOptions(budget_ms=30.0),
            name="hlod-hysteresis",
        )
        for _ in range(2)
    ]
    assert logs[0].counts.tobytes() == logs[1].counts.tobytes()
    assert logs[0].times_ns.tobytes() == logs[1].times_ns.tobytes()


def test_measured_time_makes_the_estimate_better(city: Scene, run: Callable[..., FrameLog]) -> None:
    """The relative error of the estimate narrows with the loop, as from 15.19 % to 3.89 % there."""
    errors: list[np.ndarray] = []
    for name in ("hlod-hysteresis:time_rate=0", "hlod-hysteresis"):
        log = run(name, city, speed_m_s=14.0, frames=450)
        errors.append((log["predicted_gpu_ms"] / log["gpu_ms"] - 1.0)[WARMUP:])
    without, with_loop = errors
    assert with_loop.std() < 0.5 * without.std()
    assert abs(with_loop.mean()) < min(0.02, abs(without.mean()))


@pytest.mark.parametrize("policy", ["mason-blake", "maciel"])
def test_knapsacks_keep_their_budget_over_the_whole_walk(
    city: Scene, run: Callable[..., FrameLog], policy: str
) -> None:
    """With true costs and no noise: predicted is what is taken, and never over the budget."""
    log = run(policy, city)
    assert log["predicted_gpu_ms"] == pytest.approx(log["model_gpu_ms"])
    assert log["predicted_gpu_ms"].max() <= 30.0 + 1e-9
    assert (log["missing"] == 0).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "policy", ["erikson", "screen-space-error", "cluster-cut", "hlod-hysteresis:all_children=on"]
)
def test_nothing_is_missing(city: Scene, run: Callable[..., FrameLog], policy: str) -> None:
    """Every leaf in view is stood for by something drawn, in every frame."""
    assert (run(policy, city, speed_m_s=14.0, frames=300)["missing"] == 0).all()


@pytest.mark.slow
def test_a_still_view_rests_under_noisy_times(
    city: Scene, old_machine: HardwareProfile, make_street_trace: Callable[..., CameraTrace]
) -> None:
    """Hysteresis absorbs what makes a budget from single frames flicker for ever."""
    noise = Residual("student-t", scale=0.03, dof=5.0)
    noisy = replace(old_machine, gpu_residual=noise, memory_bytes=2e9, disk_bytes_per_s=1e9)
    street = make_street_trace(WALK_M_S, 1.0)
    still = CameraTrace(
        "still",
        np.array([0.0, 60.0]),
        street.position_m[[0, 0]],
        street.orientation_xyzw[[0, 0]],
        np.zeros(2, dtype=bool),
    )
    toggles: list[float] = []
    for name in ("hlod-hysteresis", "erikson"):
        options = ReplayOptions(budget_ms=30.0, frames=800)
        log = replay(parse_policy(name).make(), city, still, noisy, options, name=name)
        toggles.append(float(log["toggles"][-200:].sum()))
    assert toggles[0] <= 4.0
    assert toggles[1] > 50.0 * max(toggles[0], 1.0)
