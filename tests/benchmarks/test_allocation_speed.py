"""Speed of the allocation against ipopt, and of the policies that use it, in one run.

Policies are timed in passes of plain numpy that culls and projects as many objects.
"""

import time
from collections.abc import Callable
from typing import Any

import casadi
import numpy as np
import pytest

from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.policies.solvers.allocation import allocate
from lodbench.policies.view import View

nlpsol: Any = casadi.nlpsol
dot: Any = casadi.dot
SX: Any = casadi.SX


def fastest_s(action: Callable[[], object], times: int) -> float:
    """Return the shortest of several runs, which other work on the machine disturbs least."""
    took: list[float] = []
    for _ in range(times):
        start = time.process_time()
        action()
        took.append(time.process_time() - start)
    return min(took)


@pytest.mark.parametrize(("n", "factor"), [(1_000, 100.0), (10_000, 1_000.0)])
def test_times_faster_than_ipopt(n: int, factor: float) -> None:
    """The same problem with bounds active on both sides; ipopt is not charged for building it."""
    rng = np.random.default_rng(n)
    a, cost = np.exp(rng.normal(6.0, 1.5, n)), 5e-6 * np.exp(rng.normal(7.0, 1.0, n))
    low = rng.uniform(0.01, 0.4, n)
    budget = float(cost @ low) + 0.4 * float(cost @ (1.0 - low))
    result = allocate(a, cost, budget, power=2.0, low=low, high=1.0)
    assert (result.x <= low).any()
    assert (result.x >= 1.0).any()
    ours_s = fastest_s(lambda: allocate(a, cost, budget, power=2.0, low=low, high=1.0), 50)

    r = SX.sym("r", n)
    problem = {"x": r, "f": dot(a / float(a.sum()), 1.0 / r), "g": dot(cost / budget, r)}
    options = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
    solver = nlpsol("solver", "ipopt", problem, options)
    start = 0.5 * (low + 1.0)
    ipopt_s = fastest_s(lambda: solver(x0=start, lbx=low, ubx=1.0, ubg=1.0), 3)
    assert solver.stats()["success"]
    print(f"\n{n} objects: {1e3 * ours_s:.3f} ms, ipopt {1e3 * ipopt_s:.1f} ms")
    assert ipopt_s > factor * ours_s


@pytest.mark.parametrize(
    "policy",
    [
        "gobbetti",
        "gobbetti:engine=newton",
        "gobbetti:m=2,weight=area",
        "wimmer",
        "peng",
        "peng:mode=water-filled",
    ],
)
def test_a_frame_of_3100_objects_takes_a_few_plain_passes(
    policy: str,
    make_levels: Callable[..., LevelTable],
    make_scene: Callable[..., Scene],
    make_hardware: Callable[..., Any],
    make_view: Callable[..., View],
    plain_ms: Callable[[Scene, Camera], float],
) -> None:
    """All in view: at most 12 in the median of frames whose objects move, and 24 in the first."""
    rng = np.random.default_rng(5)
    levels = make_levels([(3000.0, 700.0, 100.0), (800.0, 300.0, 40.0)], continuous=True)
    depth_m = rng.uniform(10.0, 200.0, 3100)
    side_m = 0.9 * depth_m * rng.uniform(-1.0, 1.0, (2, 3100))
    kind = rng.integers(0, 2, 3100)
    costs = make_hardware({"draw_calls": 1e-4, "triangles": 5e-6}).gpu
    chosen = parse_policy(policy).make()
    took_ms, peer_ms = list[float](), 0.0
    for step in range(12):
        position_m = np.stack((side_m[0], side_m[1], -depth_m + 0.05 * step), axis=1)
        scene = make_scene(position_m, kind=kind, levels=levels).with_costs(costs)
        view = make_view(scene)
        if step == 0:
            chosen.reset(scene, 12.0)
            peer_ms = plain_ms(scene, view.camera)
        assert len(view) == 3100
        start = time.process_time()
        selection = chosen.select(view)
        took_ms.append(1e3 * (time.process_time() - start))
        assert selection.predicted_ms <= 12.0
    median, first = np.median(took_ms) / peer_ms, took_ms[0] / peer_ms
    print(f"\n{policy}: {median:.1f} plain passes, the first frame {first:.1f}")
    assert median < 12.0
    assert first < 24.0
