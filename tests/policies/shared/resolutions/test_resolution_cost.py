"""Costs over resolution: exact where they can be, from above where not, and as charged."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from lodbench.base.arrays import FloatArray
from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.shared.resolutions.resolution_cost import ResolutionCosts
from lodbench.policies.view import View

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]
MakeView = Callable[..., View]
AHEAD = ((0.0, 0.0, -10.0), (2.0, 0.0, -20.0), (-3.0, 1.0, -60.0))


def table(triangles: list[float], vertices: list[float], *, continuous: bool = True) -> LevelTable:
    """One type of one draw call, with vertices that need not follow its triangles."""
    counts = np.zeros((len(triangles), len(LEVEL_PREDICTORS)))
    counts[:, LEVEL_PREDICTORS.index("draw_calls")] = 1.0
    counts[:, LEVEL_PREDICTORS.index("triangles")] = triangles
    counts[:, LEVEL_PREDICTORS.index("vertices")] = vertices
    rows = len(triangles)
    start = np.array([0, rows])
    return LevelTable(
        start, counts, np.arange(rows, dtype=float), np.ones(rows), np.array([continuous])
    )


def spent(view: View, costs: ResolutionCosts, budget_ms: float, resolution: FloatArray) -> float:
    """Return the frame's time as the allocation problem sees it."""
    problem = costs.problem(view, budget_ms)
    x = np.maximum(resolution, problem.low[: len(view)])
    second = np.minimum(resolution[problem.second], problem.high[len(view) :])
    left_ms = problem.budget_ms - float(problem.cost @ np.concatenate((x, second)))
    return budget_ms * (1.0 - 1e-9) - left_ms


def test_a_draw_call_is_fixed_and_triangles_are_proportional(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """By hand: 3 objects of 1,000 triangles at 1 µs, 0.1 ms a call, 2 ms base, 1 state change."""
    model = CostModel.of(2.0, {"draw_calls": 0.1, "triangles": 1e-3, "state_changes": 0.4})
    scene = make_scene(AHEAD, levels=make_levels(continuous=True)).with_costs(model)
    problem = ResolutionCosts(scene, "p").problem(make_view(scene), 4.0)
    assert problem.budget_ms == pytest.approx(4.0 - 2.0 - 0.4 - 3 * 0.1, rel=1e-8)
    assert_allclose(problem.cost, 1.0, rtol=1e-14)
    assert_array_equal(problem.low, 0.05)
    assert len(problem.second) == 0


def test_pixels_bound_the_resolution_from_below(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """T_pix A / (T_tri n), capped at 1, where nothing but the roofline depends on r."""
    model = CostModel.of(0.0, {}, {"triangles": 1e-3, "shaded_samples": 4e-4})
    scene = make_scene(AHEAD, levels=make_levels(continuous=True), radius_m=(5.0,)).with_costs(
        model
    )
    view = make_view(scene)
    problem = ResolutionCosts(scene, "p").problem(view, 4.0)
    bound = np.clip(4e-4 * view.area_px / (1e-3 * 1000.0), 0.05, 1.0)
    assert bound[0] == 1.0
    assert 0.05 < bound[1] < 1.0
    assert bound[2] == 0.05
    assert_allclose(problem.low, bound, rtol=1e-14)
    assert_allclose(problem.cost, (0.0, 1.0, 1.0), rtol=1e-14)
    assert problem.budget_ms == pytest.approx(4.0 - 4e-4 * view.area_px[0], rel=1e-8)


@settings(deadline=None, max_examples=100)
@given(
    linear=st.sampled_from((0.0, 2e-4)),
    geometry=st.sampled_from((0.0, 1e-3)),
    pixel=st.sampled_from((0.0, 1e-4, 1e-3)),
    seed=st.integers(0, 1000),
)
def test_the_problem_costs_what_is_predicted(
    make_scene: MakeScene,
    make_levels: MakeLevels,
    make_view: MakeView,
    linear: float,
    geometry: float,
    pixel: float,
    seed: int,
) -> None:
    """Pieces, bounds and fixed parts add up to the predicted frame at any resolution."""
    rng = np.random.default_rng(seed)
    model = CostModel.of(
        0.5,
        {"draw_calls": 0.1, "triangles": linear, "shaded_samples": 1e-5, "state_changes": 0.2},
        {"triangles": geometry, "shaded_samples": pixel},
    )
    levels = make_levels([(1000.0, 400.0, 100.0), (300.0, 30.0), (50.0,)], continuous=True)
    position_m = np.column_stack((rng.uniform(-3, 3, (9, 2)), rng.uniform(-30, -8, 9)))
    kind = rng.integers(0, 3, 9)
    scene = make_scene(position_m, levels=levels, kind=kind).with_costs(model)
    view = make_view(scene)
    costs = ResolutionCosts(scene, "p")
    lowest = levels.min_resolution[view.type_index]
    resolution = lowest + rng.random(9) * (1.0 - lowest)
    predicted_ms = costs.predict_ms(view, resolution)
    assert spent(view, costs, 20.0, resolution) == pytest.approx(predicted_ms, rel=1e-12)


def test_two_pieces_are_filled_in_order(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """Below the kink an object costs what is linear, above it the geometry too."""
    model = CostModel.of(0.0, {"triangles": 1e-4}, {"triangles": 1e-3, "shaded_samples": 4e-4})
    scene = make_scene(AHEAD[1:2], levels=make_levels(continuous=True), radius_m=(5.0,)).with_costs(
        model
    )
    view = make_view(scene)
    problem = ResolutionCosts(scene, "p").problem(view, 4.0)
    kink = 4e-4 * view.area_px[0] / 1.0
    assert problem.second.tolist() == [0]
    assert_allclose(problem.cost, (1.1, 0.1), rtol=1e-13)
    assert_allclose(problem.low, (kink, 0.05), rtol=1e-13)
    assert_allclose(problem.high, (1.0, kink), rtol=1e-13)
    assert problem.resolution(np.array([kink, 0.1])).tolist() == pytest.approx([0.1])
    assert problem.resolution(np.array([0.9, kink])).tolist() == pytest.approx([0.9])


def test_costs_off_a_line_are_taken_from_above(make_scene: MakeScene, make_view: MakeView) -> None:
    """Vertices that fall slower than triangles: no knot costs more than its line says."""
    levels = table([1000.0, 500.0, 100.0], [600.0, 500.0, 100.0])
    model = CostModel.of(0.0, {"vertices": 1e-3})
    scene = make_scene(AHEAD, levels=levels).with_costs(model)
    view = make_view(scene)
    costs = ResolutionCosts(scene, "p")
    for resolution in (0.1, 0.3, 0.5, 0.8, 1.0):
        each = np.full(3, resolution)
        above_ms = spent(view, costs, 1.7, each) - costs.predict_ms(view, each)
        excess = 0.0 if resolution == 0.5 else 1e-3
        assert above_ms >= -1e-12
        assert (above_ms > excess) == (resolution != 0.5)


def test_everything_in_full_is_known_to_fit(make_scene: MakeScene, make_view: MakeView) -> None:
    """Though the line above says 2.3 ms, the exact 1.8 ms of full detail fit into 1.9."""
    levels = table([1000.0, 500.0, 100.0], [600.0, 500.0, 100.0])
    scene = make_scene(AHEAD, levels=levels).with_costs(CostModel.of(0.0, {"vertices": 1e-3}))
    costs = ResolutionCosts(scene, "p")
    assert costs.problem(make_view(scene), 1.9).budget_ms == np.inf
    assert costs.problem(make_view(scene), 1.79).budget_ms < 1.79


def test_discrete_types_get_the_level_not_above(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """Of levels at 1, 0.25 and 0.05: 0.9 and 0.25 give the second, 0.1 the third."""
    levels = make_levels([(1000.0, 250.0, 50.0)] * 2, continuous=[False, True])
    model = CostModel.of(0.0, {"triangles": 1e-3})
    position_m = [(0.0, 0.0, -10.0)] * 5
    scene = make_scene(position_m, levels=levels, kind=[0, 0, 0, 0, 1]).with_costs(model)
    costs, view = ResolutionCosts(scene, "p"), make_view(scene)
    wanted = np.array([1.0, 0.9, 0.25, 0.1, 0.9])
    detail = costs.detail(view, wanted)
    assert detail.tolist() == [0.0, 1.0, 1.0, 2.0, 0.9]
    assert costs.resolution(view, detail).tolist() == [1.0, 0.25, 0.25, 0.05, 0.9]
    assert costs.detail(view, costs.lowest(view)).tolist() == [2.0, 2.0, 2.0, 2.0, 0.05]


def test_a_scene_without_costs_is_refused(make_scene: MakeScene) -> None:
    """The message says which policy wants them, and how to bind them."""
    with pytest.raises(InputError, match=r"wimmer: expected a scene with a cost model.*with_costs"):
        ResolutionCosts(make_scene(AHEAD), "wimmer")
