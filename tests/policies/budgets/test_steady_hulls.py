"""What policies keep of a scene between frames, compared with what they find out in every frame."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.motion import Placed
from lodbench.models.scene.scene import Scene
from lodbench.policies.protocol import Clairvoyant, Policy, Truth
from lodbench.policies.registry import parse_policy
from lodbench.policies.selection import Selection
from lodbench.policies.shared.resolutions import steady_costs
from lodbench.policies.shared.resolutions.resolution_cost import ResolutionCosts
from lodbench.policies.view import View

Make = Callable[..., Any]
COSTS = CostModel.of(1.0, {"triangles": 1e-3, "draw_calls": 1e-2, "shaded_samples": 1e-6})
CHAINS = [(4000.0, 2000.0, 700.0, 90.0), (300.0, 90.0, 20.0), (50.0,)]
FRAMES = 12

PLACES = {
    "funkhouser": ("funkhouser", "make_level_hulls"),
    "oracle": ("oracle", "make_level_hulls"),
    "zach": ("zach", "make_flat_levels"),
}


def make_crowd(make_scene: Make, make_levels: Make, continuous: bool) -> Scene:
    """Return 120 objects of three types about the origin, some of no importance."""
    rng = np.random.default_rng(4)
    levels = make_levels(CHAINS, continuous=continuous)
    position_m = rng.uniform(-40.0, 40.0, (120, 3))
    importance = np.where(rng.random(120) < 0.1, 0.0, rng.uniform(0.5, 2.0, 120))
    kind = rng.integers(0, 3, 120)
    scene = make_scene(position_m, kind=kind, levels=levels, importance=importance)
    return scene.with_costs(COSTS)


def walk(policy: Policy, scene: Scene, make_view: Make, budget_ms: float) -> list[Selection]:
    """Return what a policy selects while objects come into view and leave it, every third frame."""
    policy.reset(scene, budget_ms)
    rng, selections, inside = np.random.default_rng(1), list[Selection](), np.zeros(0)
    state = make_view(scene).state
    for frame in range(FRAMES):
        if frame % 3 == 0:
            inside = rng.random(len(scene)) < 0.6
        centers_m = state.centers_m.copy()
        centers_m[2] = -np.abs(centers_m[2]) - 2.0 - 0.2 * frame
        ids = np.flatnonzero(inside).astype(np.int32)
        now = replace(state, centers=Placed.at_rest(centers_m), inside=inside, frame=frame)
        view = View(now, ids, now.camera.to_camera(centers_m[:, ids]))
        if isinstance(policy, Clairvoyant):
            policy.foresee(Truth(COSTS, 1.0))
        selections.append(policy.select(view))
    return selections


def check_equal(got: list[Selection], expected: list[Selection]) -> None:
    """Compare what is drawn, the predicted times and the work of all frames."""
    for mine, other in zip(got, expected, strict=True):
        assert mine.ids.tolist() == other.ids.tolist()
        assert_allclose(mine.detail, other.detail, rtol=1e-12)
        assert_allclose(mine.predicted_ms, other.predicted_ms, rtol=1e-12)
        assert mine.work == other.work


@pytest.mark.parametrize("budget_ms", [2.0, 6.0, 20.0, 60.0, 500.0])
@pytest.mark.parametrize(
    "spec",
    [
        "funkhouser",
        "funkhouser:misfit=skip,hysteresis=0.3",
        "funkhouser:hysteresis=0,focus=0,motion=0",
        "oracle:exact_up_to=0",
        "zach",
        "zach:engine=newton,max_steps=3",
    ],
)
def test_tables_of_types_select_what_tables_of_objects_do(
    spec: str,
    budget_ms: float,
    make_scene: Make,
    make_levels: Make,
    make_view: Make,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without them the same policy builds hulls and increments of every object in every frame."""
    scene = make_crowd(make_scene, make_levels, continuous=False)
    got = walk(parse_policy(spec).make(), scene, make_view, budget_ms)
    name, maker = PLACES[spec.partition(":")[0]]
    folder = "bounds" if name == "oracle" else "budgets"

    def refuse(*args: object) -> None:
        """Say that nothing is the same in every frame."""

    monkeypatch.setattr(f"lodbench.policies.{folder}.{name}.{maker}", refuse)
    check_equal(got, walk(parse_policy(spec).make(), scene, make_view, budget_ms))


@pytest.mark.parametrize("continuous", [True, False])
@pytest.mark.parametrize("budget_ms", [2.0, 20.0, 60.0, 500.0])
@pytest.mark.parametrize("spec", ["gobbetti:engine=newton", "wimmer", "peng:mode=water-filled"])
def test_lines_of_types_allocate_what_lines_of_objects_do(
    spec: str,
    budget_ms: float,
    continuous: bool,
    make_scene: Make,
    make_levels: Make,
    make_view: Make,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Without them the same policy asks the cost model about every object in every frame."""
    scene = make_crowd(make_scene, make_levels, continuous)
    got = walk(parse_policy(spec).make(), scene, make_view, budget_ms)
    monkeypatch.setattr(steady_costs, "SteadyCosts", ResolutionCosts)
    check_equal(got, walk(parse_policy(spec).make(), scene, make_view, budget_ms))


def test_a_roofline_or_a_term_that_reads_levels_is_asked_for_in_every_frame(
    make_scene: Make, make_levels: Make
) -> None:
    """There hulls are not the same in every frame, and neither are lines."""
    scene = make_crowd(make_scene, make_levels, continuous=False)
    for costs in (
        CostModel.of(1.0, {"draw_calls": 1e-2}, {"triangles": 1e-3, "shaded_samples": 1e-5}),
        CostModel.of(1.0, {"rasterized_triangles": 1e-3}),
    ):
        bound = scene.with_costs(costs)
        made = steady_costs.make_resolution_costs(bound, "p")
        assert type(made) is ResolutionCosts
        policy = parse_policy("funkhouser").make()
        policy.reset(bound, 8.0)
        assert vars(policy)["_hulls"] is None
        policy = parse_policy("zach").make()
        policy.reset(bound, 8.0)
        assert vars(policy)["_flat"] is None
