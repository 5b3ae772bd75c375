"""What ``desktop-assumed`` charges for a policy's own work, beside compiled loops that do the work.

Numba compiles them to what a C compiler makes of the same loops, without arrays on the way.  They
first have to decide as the policies do.  A price is right within `FACTOR` both ways: what an object
costs depends on where its data lie, and what a processor does in a nanosecond on its year.
"""

import math
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from lodbench.base.predictors import CPU_PREDICTORS
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.policies.solvers.value_greedy import greedy_by_value

numba: Any = pytest.importorskip("numba", reason="numba is only in the dependency group `bench`")

FACTOR = 4.0
UPRIGHT = (math.sin(math.pi / 4), 0.0, 0.0, math.cos(math.pi / 4))  # looks along +y, z up


@numba.njit
def choose_levels(
    objects: Any, order: Any, eye: Any, per_ratio: Any, threshold: Any, hysteresis: Any, level: Any
) -> None:
    """Bring levels to those of ``static-screen``, object by object, as an engine's loop does."""
    for k in range(len(order)):
        i = order[k]
        x, y, z = objects[i, 0] - eye[0], objects[i, 1] - eye[1], objects[i, 2] - eye[2]
        radius = objects[i, 3]
        height = per_ratio * radius / max(math.sqrt(x * x + y * y + z * z), radius)
        last, new = int(objects[i, 4]), 0
        while new < last and height < threshold[new]:
            new += 1
        if new < level[i]:
            new = 0
            while new < last and height - hysteresis < threshold[new]:
                new += 1
            new = min(new, level[i])
        level[i] = new


@numba.njit
def take_by_value(cost: Any, benefit: Any, budget: Any, column: Any) -> None:
    """Bring columns to those of a greedy pass over all pairs of object and level, best first."""
    n, width = cost.shape
    order = np.argsort((-benefit / cost).ravel(), kind="mergesort")
    left = budget
    for i in range(n):
        left -= cost[i, column[i]]
    for at in order:
        i, j = at // width, at % width
        more = cost[i, j] - cost[i, column[i]]
        if benefit[i, j] > benefit[i, column[i]] and more <= left:
            left -= more
            column[i] = j


@numba.njit
def sift(keys: Any, grow: Any, steps: Any) -> None:
    """Take the best of a binary heap and put it back worse, as an optimiser's loop does."""
    size = len(keys)
    for step in range(steps):
        key, i = keys[0] + grow[step % len(grow)], 0
        while True:
            child = 2 * i + 1
            if child >= size:
                break
            if child + 1 < size and keys[child + 1] < keys[child]:
                child += 1
            if keys[child] >= key:
                break
            keys[i], i = keys[child], child
        keys[i] = key


def median_ns(action: Callable[[], object]) -> float:
    """Return the median processor time of 15 runs; the first compiles, and is not counted."""
    action()
    took: list[float] = []
    for _ in range(15):
        start = time.process_time_ns()
        action()
        took.append(time.process_time_ns() - start)
    return statistics.median(took)


def price_ns(**counts: float) -> float:
    """Return what `desktop-assumed` charges for a policy's work."""
    cpu = load_hardware("desktop-assumed").cpu
    return 1e6 * cpu.frame_ms(dict.fromkeys(CPU_PREDICTORS, 0.0) | counts)[1]


def build_objects(count: int, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return records of 256 bytes, as engines keep them: place, radius, coarsest level, others."""
    objects = rng.uniform(-100.0, 100.0, (count, 32))
    objects[:, 3], objects[:, 4] = rng.uniform(0.5, 3.0, count), 4.0
    return objects


def test_the_loop_decides_as_static_screen_does(
    make_scene: Callable[..., Scene], make_levels: Callable[..., Any], make_view: Callable[..., Any]
) -> None:
    """Ten frames of a camera that comes nearer and goes, hysteresis and all."""
    rng = np.random.default_rng(3)
    objects = build_objects(400, rng)
    objects[:, :3] = np.column_stack(
        (rng.uniform(-1, 1, 400), rng.uniform(5, 60, 400), np.zeros(400))
    )
    objects[:, 3] = 0.5
    scene = make_scene(objects[:, :3], radius_m=0.5, levels=make_levels([(160, 80, 40, 20, 10)]))
    policy: Any = parse_policy("static-screen").make()
    policy.reset(scene, 16.7)
    # From the finest there is nothing finer, so that the first frame has no hysteresis.
    ours, detail = np.zeros(400, dtype=np.int64), np.full(400, np.nan)
    threshold = policy.first * policy.ratio ** np.arange(4.0)
    for frame in range(10):
        eye = np.array((0.0, -1.5 * abs(frame - 5), 0.0))
        camera = Camera((0.0, float(eye[1]), 0.0), UPRIGHT, 1280, 720, math.radians(60.0))
        view = make_view(scene, camera, detail=detail)
        selection = policy.select(view)
        assert len(selection.ids) == 400
        assert selection.work.objects_visited == 400
        detail = detail.copy()
        detail[selection.ids] = selection.detail
        per_ratio = 2.0 * camera.focal_px / camera.height_px
        choose_levels(objects, selection.ids, eye, per_ratio, threshold, policy.hysteresis, ours)
        assert ours.tolist() == detail.tolist()
    assert len(set(detail.tolist())) > 2


def test_a_visit_lies_between_objects_at_hand_and_objects_far_apart() -> None:
    """3,000 objects in cache cost less than their price, 100,000 strewn over memory more."""
    rng = np.random.default_rng(4)
    threshold, took = 0.25 * 0.5 ** np.arange(4.0), list[float]()
    for count in (3_000, 100_000):
        objects, level = build_objects(count, rng), np.zeros(count, dtype=np.int64)
        order, eye = rng.permutation(count), np.zeros(3)

        def pass_over(o: Any = objects, k: Any = order, e: Any = eye, x: Any = level) -> None:
            e[0] += 0.1
            for _ in range(100_000 // len(k)):
                choose_levels(o, k, e, 1.7, threshold, 0.01, x)

        took.append(median_ns(pass_over) / (100_000 // count * count))
    near, far = took
    price = price_ns(objects_visited=1.0)
    print(f"\na visit: {near:.1f} ns in cache, {far:.1f} ns strewn; the price is {price:.1f} ns")
    assert near < far
    assert price / FACTOR < far
    assert near < price * FACTOR
    assert near / FACTOR < price < far * FACTOR


def test_a_frame_of_funkhouser_costs_what_its_counts_say() -> None:
    """15,500 pairs of object and level, sorted and taken: the loop takes the same, and as long."""
    rng = np.random.default_rng(5)
    count, width = 3_100, 5
    cost: Any = np.cumprod(rng.uniform(1.5, 3.0, (count, width)), axis=1)
    benefit: Any = np.cumsum(rng.uniform(0.01, 1.0, (count, width)), axis=1)
    start = np.zeros(count, dtype=np.int64)
    budget = 4.0 * float(cost[:, 0].sum())
    ours = start.copy()
    take_by_value(cost, benefit, budget, ours)
    assert ours.tolist() == greedy_by_value(cost, benefit, budget, start.astype(np.int32)).tolist()
    took = median_ns(lambda: take_by_value(cost, benefit, budget, start.copy()))
    pairs = count * width
    price = price_ns(comparisons=float(pairs * pairs.bit_length()))
    print(
        f"\na greedy pass: {took / 1e6:.2f} ms; the price of its comparisons is {price / 1e6:.2f}"
    )
    assert price / FACTOR < took < price * FACTOR


def test_an_iteration_is_charged_for_more_than_a_step_in_a_heap() -> None:
    """A step of an optimiser that does no more than reorder a heap is ten times too dear."""
    rng = np.random.default_rng(6)
    keys, grow = np.sort(rng.exponential(size=3_100)), rng.exponential(size=1_000)
    took = median_ns(lambda: sift(keys, grow, 20_000)) / 20_000
    price = price_ns(iterations=1.0)
    print(
        f"\na step in a heap of 3,100: {took:.0f} ns; the price of an iteration is {price:.0f} ns"
    )
    assert took < price < 50.0 * took
