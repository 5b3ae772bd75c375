"""What a GPU that selects and makes every level anew counts, on a frame of three objects."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.base.predictors import GPU_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.frame_cost import FrameCost
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.gobbetti import Gobbetti
from lodbench.policies.view import View

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]
MakeView = Callable[..., View]

COSTS = CostModel.of(
    1.0,
    {
        "triangles": 1e-3,
        "reformed_triangles": 2e-4,
        "reformed_objects": 0.1,
        "reduction_steps": 0.25,
    },
)
PLACES = [(0.0, 0.0, -10.0), (1.0, 0.0, -20.0), (1.0, 1.0, -40.0), (-1.0, 1.0, -40.0)]


def test_four_objects(make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView) -> None:
    """1,000 + 100 + 550 + 100 triangles, four objects, two steps in which four are summed."""
    levels = make_levels([(1000.0, 100.0)], continuous=True)
    view = make_view(make_scene(PLACES, levels=levels))
    costs = FrameCost(COSTS, levels)
    row, fraction = np.array([0, 1, 0, 1]), np.array([0.0, 0.0, 0.5, 0.0])
    price = costs.frame(row, view, view.camera.viewport_px, fraction=fraction)
    counts = dict(zip(GPU_PREDICTORS, price.units, strict=True))
    assert counts["reformed_triangles"] == counts["triangles"] == 1750.0
    assert counts["reformed_objects"] == 4.0
    assert counts["reduction_steps"] == 2.0
    assert price.gpu_ms == pytest.approx(1.0 + 1.75 + 0.35 + 0.4 + 0.5)


def test_policies_foresee_them(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """An allocation spends its whole budget on triangles of 1.2 µs, beside 1 + 0.4 + 0.5 ms."""
    levels = make_levels([(1000.0, 100.0)], continuous=True)
    scene = make_scene(PLACES, levels=levels).with_costs(COSTS)
    view = make_view(scene)
    policy = Gobbetti()
    policy.reset(scene, 4.0)
    selection = policy.select(view)
    assert float(selection.detail.sum()) * 1000.0 * 1.2e-3 == pytest.approx(4.0 - 1.9, rel=1e-6)
    row, fraction = levels.position(view.type_index, selection.detail)
    price = FrameCost(COSTS, levels).frame(row, view, view.camera.viewport_px, fraction=fraction)
    assert selection.predicted_ms == pytest.approx(price.gpu_ms, rel=1e-9)
    assert price.gpu_ms == pytest.approx(4.0, rel=1e-6)


def test_nothing_drawn_takes_no_step() -> None:
    """Neither does one object, whose sum is itself."""
    costs = FrameCost(
        COSTS,
        LevelTable(np.array([0, 1]), np.zeros((1, 7)), np.zeros(1), np.zeros(1), np.array([False])),
    )
    assert costs.fixed_ms(1e6, 0, 0) == costs.fixed_ms(1e6, 1, 1) == 1.0
    assert costs.fixed_ms(1e6, 1, 1_024) == pytest.approx(1.0 + 2.5)
