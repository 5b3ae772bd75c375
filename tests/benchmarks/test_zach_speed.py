"""Speed of mixed selection: what splitting spares at 20,000 groups; a frame of 3,100 objects.

Frames are timed in passes of plain numpy that culls and projects all nodes, in the same run.
"""

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.zach import Zach
from lodbench.policies.selection import Selection
from lodbench.policies.shared.mixed.zach_groups import Plan
from lodbench.policies.view import View

Make = Callable[..., Any]
Plain = Callable[[Scene, Camera], float]
CHEAP_SETUP = CostModel.of(1.0, {"draw_calls": 1e-7, "splats": 5e-6, "vertices": 1e-5})


def timed(policy: Zach, views: list[View]) -> tuple[Selection, float]:
    """Return the last selection, and the median of the times in ms."""
    took_ms: list[float] = []
    selection = policy.select(views[0])
    for view in views[1:]:
        start = time.process_time()
        selection = policy.select(view)
        took_ms.append(1e3 * (time.process_time() - start))
    return selection, statistics.median(took_ms)


def test_splitting_spares_variables_and_time_at_20000_groups(
    make_styria: Make, make_view: Make, flyover: Camera, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All of 20,000 groups in view drawn; the paper's rays, which end at the first bound."""
    scene = make_styria(0, forest_depth=8, wooded=0.42).with_costs(CHEAP_SETUP)
    view = make_view(scene, flyover)
    roots = scene.roots[view.state.inside[scene.roots]]
    plans: list[Plan] = []
    resolution = Plan.resolution

    def note(plan: Plan, x: Any) -> Any:
        plans.append(plan)
        return resolution(plan, x)

    monkeypatch.setattr(Plan, "resolution", note)
    took_ms: dict[bool, float] = {}
    for splitting, frames in ((True, 4), (False, 2)):
        policy = Zach(splitting=splitting, engine="gradient", max_steps=100_000)
        policy.reset(scene, 500.0)
        selection, took_ms[splitting] = timed(policy, [view.at(roots) for _ in range(frames)])
        assert selection.predicted_ms == pytest.approx(500.0, rel=1e-6)
        print(f"\nsplitting={splitting}: {took_ms[splitting]:.0f} ms, {selection.work}")
    groups, variables = len(plans[0].ids), len(plans[0].weight)
    print(f"{groups} groups, {variables} variables")
    assert groups >= 20_000
    assert variables <= groups / 10
    assert len(plans[-1].weight) == groups
    assert took_ms[True] < took_ms[False] / 4.0


def test_a_frame_of_20000_groups_takes_a_few_plain_passes(
    make_styria: Make, make_view: Make, plain_ms: Plain, flyover: Camera
) -> None:
    """At most 8, with the paper's costs and budget, as `styria` needs it, and the defaults."""
    costs = {"draw_calls": 2.45e-3, "splats": 0.35e-3, "vertices": 0.06e-3}
    scene = make_styria(0, forest_depth=8, wooded=0.42).with_costs(CostModel.of(1.0, costs))
    view = make_view(scene, flyover)
    roots = scene.roots[view.state.inside[scene.roots]]
    for costs in (scene, scene.with_costs(CHEAP_SETUP)):
        policy = Zach()
        policy.reset(costs, 100.0)
        _, took_ms = timed(policy, [view.at(roots) for _ in range(10)])
        passes = took_ms / plain_ms(costs, flyover)
        print(f"\n{took_ms:.1f} ms, {passes:.1f} plain passes")
        assert passes < 8.0


@pytest.mark.parametrize("continuous", [[True, True], [False, False], [True, False]])
def test_a_frame_of_3100_objects_takes_a_few_plain_passes(
    continuous: list[bool], make_levels: Make, make_scene: Make, make_view: Make, plain_ms: Plain
) -> None:
    """At most 25; flat scenes, all in view, each object a variable or a chain of increments."""
    rng = np.random.default_rng(5)
    chains = [(3000.0, 700.0, 100.0), (800.0, 300.0, 40.0)]
    levels = make_levels(chains, continuous=continuous)
    depth_m = rng.uniform(10.0, 200.0, 3100)
    side_m = 0.9 * depth_m * rng.uniform(-1.0, 1.0, (2, 3100))
    position_m = np.stack((side_m[0], side_m[1], -depth_m), axis=1)
    scene = make_scene(position_m, kind=rng.integers(0, 2, 3100), levels=levels)
    scene = scene.with_costs(CostModel.of(1.0, {"draw_calls": 1e-4, "triangles": 5e-6}))
    policy = Zach()
    policy.reset(scene, 12.0)
    selection, took_ms = timed(policy, [make_view(scene) for _ in range(12)])
    assert len(selection.ids) == 3100
    assert 11.9 < selection.predicted_ms <= 12.0
    passes = took_ms / plain_ms(scene, make_view(scene).camera)
    print(f"\n{continuous}: {took_ms:.2f} ms, {passes:.1f} plain passes, {selection.work}")
    assert passes < 25.0


def test_a_frame_of_3100_nodes_takes_a_few_plain_passes(
    make_styria: Make, make_view: Make, plain_ms: Plain, flyover: Camera
) -> None:
    """At most 30; a terrain of 1,365 patches and a quadtree of more than 1,700 nodes over trees."""
    scene = make_styria(3, terrain_depth=5, forest_depth=6, wooded=0.35)
    assert len(scene) > 3100
    costs = {"draw_calls": 1e-5, "splats": 5e-6, "vertices": 1e-5}
    scene = scene.with_costs(CostModel.of(1.0, costs))
    view = make_view(scene, flyover)
    roots = scene.roots[view.state.inside[scene.roots]]
    policy = Zach()
    policy.reset(scene, 16.0)
    selection, took_ms = timed(policy, [view.at(roots) for _ in range(12)])
    passes = took_ms / plain_ms(scene, flyover)
    print(f"\n{len(scene)} nodes: {took_ms:.2f} ms, {passes:.1f} plain passes, {selection.work}")
    assert passes < 30.0
