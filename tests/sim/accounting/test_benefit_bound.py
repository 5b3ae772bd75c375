"""The most benefit that frames of a cost can have, by kept hulls and by hulls of every object."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.frame_cost import FrameCost
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.shared.levels.choices import LevelChoices, importance
from lodbench.policies.solvers.knapsack import hull_increments, relaxed_bound
from lodbench.policies.view import View
from lodbench.sim.accounting.benefit_bound import BenefitBound

CHAINS = [(3000.0, 1500.0, 700.0, 100.0), (800.0, 300.0, 40.0), (500.0,)]
PLAIN = {"draw_calls": 1e-3, "triangles": 1e-4, "shaded_samples": 1e-6, "state_changes": 0.05}
OF_LEVELS = {"triangles": 1e-4, "rasterized_triangles": 1e-4}


@pytest.mark.parametrize("unit_ms", [PLAIN, OF_LEVELS], ids=["kept hulls", "hulls of a frame"])
def test_the_bound_is_the_relaxed_optimum_of_the_offer(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_view: Callable[..., View],
    unit_ms: dict[str, float],
) -> None:
    """At costs from less than the coarsest to more than the finest, rounding aside."""
    rng = np.random.default_rng(7)
    x, y, z = rng.uniform(-40, 40, 120), rng.uniform(-10, 10, 120), rng.uniform(-90, -3, 120)
    scene = make_scene(
        np.stack((x, y, z), axis=1),
        kind=rng.integers(0, 3, 120),
        importance=rng.uniform(0.5, 2.0, 120),
        radius_m=(1.0, 0.7, 0.5),
        levels=make_levels(CHAINS),
    )
    costs = FrameCost(CostModel.of(1.0, unit_ms), scene.types.levels)
    view = make_view(scene)
    offer = LevelChoices(scene, costs, 1.0).offer(view, importance)
    increments = hull_increments(offer.cost_ms, offer.benefit)
    least_ms = offer.fixed_ms + increments.base_cost
    bound = BenefitBound(scene, costs, 1)
    for share in (-0.01, 0.0, 0.1, 0.5, 0.9, 1.5):
        gpu_ms = least_ms + share * float(increments.cost.sum())
        left_ms = gpu_ms * (1.0 + 1e-12) - offer.fixed_ms
        expected = relaxed_bound(increments, left_ms)
        assert bound.of(view, gpu_ms) == pytest.approx(expected, rel=1e-12)
    assert bound.of(view, least_ms - 0.01) == -np.inf
    assert len(view) > 50


def test_only_frames_that_are_asked_for_have_a_bound(
    make_scene: Callable[..., Scene], make_view: Callable[..., View]
) -> None:
    """None with `every` 0; the first frame is one of every other."""
    scene = make_scene([(0.0, 0.0, -4.0)])
    costs = FrameCost(CostModel.of(1.0, {"triangles": 1e-4}), scene.types.levels)
    view = make_view(scene)
    assert np.isnan(BenefitBound(scene, costs, 0).of(view, 9.0))
    assert np.isfinite(BenefitBound(scene, costs, 2).of(view, 9.0))
