"""``gobbetti-custom``: the default is `gobbetti`, other formulas are optimal, failures are said."""

import pickle
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from lodbench.base.arrays import FloatArray
from lodbench.base.errors import InputError, PolicyError
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.gobbetti import Gobbetti
from lodbench.policies.budgets.gobbetti_custom import GobbettiCustom
from lodbench.policies.registry import parse_policy
from lodbench.policies.solvers.convex_program import ConvexProgram, Point
from lodbench.policies.view import View
from lodbench.sim.frame_log import COUNTS
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]
MakeView = Callable[..., View]
MakeHardware = Callable[..., HardwareProfile]
MakeTrace = Callable[..., CameraTrace]
Crowd = Callable[..., Scene]

COSTS = CostModel.of(1.0, {"draw_calls": 1e-3, "triangles": 1e-4})
PAGE = Path(__file__).parents[3] / "docs" / "adding-a-heuristic.md"


@pytest.fixture(name="crowd")
def fixture_crowd(make_scene: MakeScene, make_levels: MakeLevels) -> Crowd:
    """Build 60 objects of two types ahead of the camera, of which some come into view later."""

    def build(*, continuous: bool | list[bool] = True) -> Scene:
        rng = np.random.default_rng(7)
        x, y, z = rng.uniform(-30, 30, 60), rng.uniform(-10, 10, 60), rng.uniform(-90, -3, 60)
        levels = make_levels([(3000.0, 700.0, 100.0), (800.0, 300.0, 40.0)], continuous=continuous)
        kind, importance = rng.integers(0, 2, 60), rng.uniform(0.5, 2.0, 60)
        position_m = np.stack((x, y, z), axis=1)
        return make_scene(position_m, kind=kind, importance=importance, levels=levels)

    return build


def log_columns(policy: object, scene: Scene, hardware: HardwareProfile) -> FloatArray:
    """Replay along a path and return predicted and charged time of each frame, (frames, 2)."""
    trace = CameraTrace(
        "path",
        np.array([0.0, 1.0]),
        np.array([(0.0, 0.0, 0.0), (3.0, 0.0, -30.0)]),
        np.array([(0.0, 0.0, 0.0, 1.0)] * 2),
        np.zeros(2, dtype=np.bool_),
    )
    options = ReplayOptions(budget_ms=4.0, frames=25)
    log = replay(policy, scene, trace, hardware, options, name="custom")  # pyright: ignore[reportArgumentType] - loaded by name
    names = ("predicted_gpu_ms", "model_gpu_ms")
    return log.counts[:, [COUNTS.index(name) for name in names]]


def test_the_default_formulas_are_gobbetti(crowd: Crowd, make_view: MakeView) -> None:
    """The same resolutions as the exact solver, within ipopt's tolerance, and sooner when warm."""
    scene = crowd().with_costs(COSTS)
    custom = GobbettiCustom()
    exact = Gobbetti(engine="newton", velocity=False, eccentricity=False)
    for policy in (custom, exact):
        policy.reset(scene, 5.0)
    view = make_view(scene)
    iterations: list[int] = []
    for _ in range(3):
        ours, best = custom.select(view), exact.select(view)
        assert_allclose(ours.detail, best.detail, rtol=1e-4)
        assert 5.0 * (1.0 - 2e-5) < ours.predicted_ms <= 5.0
        iterations.append(ours.work.iterations)
    assert iterations[1] < 0.7 * iterations[0]
    assert custom.failures == 0


def test_another_pair_of_formulas_is_optimal(crowd: Crowd, make_view: MakeView) -> None:
    """Between the bounds, slope of degradation over slope of cost is equal."""
    scene = crowd().with_costs(COSTS)
    policy = GobbettiCustom(
        degradation="importance * sqrt(area) * exp(-3 * r)",
        cost="fixed_ms + slope_ms * r * (1 + r) / 2",
    )
    policy.reset(scene, 4.0)
    view = make_view(scene)
    selection = policy.select(view)
    r = selection.detail
    slope_ms = np.where(view.type_index == 0, 0.3, 0.08)
    value = scene.importance[view.ids] * np.sqrt(view.area_px) * 3.0 * np.exp(-3.0 * r)
    ratio = value / (slope_ms * (0.5 + r))
    free = (r > scene.types.levels.min_resolution[view.type_index] * 1.001) & (r < 0.999)
    assert free.sum() > 5
    assert_allclose(ratio[free], np.median(ratio[free]), rtol=1e-3)
    spent_ms = float((1e-3 + slope_ms * r * (1.0 + r) / 2.0).sum())
    assert selection.predicted_ms == pytest.approx(1.0 + spent_ms, rel=1e-12)
    assert 3.999 < selection.predicted_ms <= 4.0


@pytest.mark.parametrize("continuous", [True, False, [True, False]], ids=["r", "lod", "both"])
@pytest.mark.parametrize("roofline", [{}, {"triangles": 5e-5, "shaded_samples": 5e-5}])
def test_replayed_end_to_end(
    crowd: Crowd,
    make_hardware: MakeHardware,
    continuous: bool | list[bool],
    roofline: dict[str, float],
) -> None:
    """What is predicted is what is charged, and never above the budget."""
    hardware = make_hardware({"triangles": 5e-5, "draw_calls": 5e-3}, roofline=roofline)
    policy = GobbettiCustom()
    predicted_ms, charged_ms = log_columns(policy, crowd(continuous=continuous), hardware).T
    assert_allclose(predicted_ms, charged_ms, rtol=1e-12)
    assert (predicted_ms <= 4.0).all()
    assert policy.failures == 0


def test_infeasible_and_generous_budgets(crowd: Crowd, make_view: MakeView) -> None:
    """Below the lowest cost nothing is solved and the lowest drawn; with much time all is full."""
    scene = crowd().with_costs(COSTS)
    view = make_view(scene)
    policy = GobbettiCustom()
    policy.reset(scene, 1.05)
    selection = policy.select(view)
    assert_array_equal(selection.detail, scene.types.levels.min_resolution[view.type_index])
    assert selection.predicted_ms > 1.05
    assert selection.work.iterations == policy.failures == 0
    policy.reset(scene, 100.0)
    assert_allclose(policy.select(view).detail, 1.0, rtol=1e-5)


def test_a_failed_solver_draws_the_lowest_and_says_so(
    crowd: Crowd, make_view: MakeView, caplog: pytest.LogCaptureFixture
) -> None:
    """One iteration is too few; every such frame is counted and the first is logged."""
    scene = crowd().with_costs(COSTS)
    view = make_view(scene)
    policy = GobbettiCustom(max_iterations=1)
    policy.reset(scene, 5.0)
    lowest, again = policy.select(view), policy.select(view)
    assert_array_equal(lowest.detail, scene.types.levels.min_resolution[view.type_index])
    assert again.predicted_ms <= 5.0
    assert policy.failures == 2
    said = [record.getMessage() for record in caplog.records]
    assert len(said) == 1
    assert "frame 0: ipopt gave Maximum_Iterations_Exceeded" in said[0]


def test_a_failed_solver_keeps_the_last_frame_where_it_fits(
    crowd: Crowd, make_view: MakeView
) -> None:
    """A formula that overflows once objects move: the resolutions of the frame before stay."""
    scene = crowd().with_costs(COSTS)
    still = make_view(scene)
    before = Camera((1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 100, 100, np.pi / 2)
    moving = make_view(scene, previous_camera=before, step_s=0.01)
    assert moving.speed_deg_s.min() > 1.0
    overflowing = "exp(min(1, speed) * 1e5 * (r - 0.2))"
    policy = GobbettiCustom(f"importance * area / triangles / r + {overflowing}")
    policy.reset(scene, 5.0)
    kept = policy.select(still)
    assert policy.failures == 0
    assert_allclose(policy.select(moving).detail, kept.detail, rtol=1e-15)
    assert policy.failures == 1


def test_a_formula_without_a_value_fails_by_name(crowd: Crowd, make_hardware: MakeHardware) -> None:
    """The logarithm of a speed that is 0 in the first frame; node and values are in the message."""
    policy = GobbettiCustom(degradation="log(speed) / r")
    with pytest.raises(PolicyError, match=r"degradation: expected finite .* node \d+ .*speed 0,"):
        log_columns(policy, crowd(), make_hardware({"triangles": 5e-5}))


@pytest.mark.parametrize(
    ("policy", "message"),
    [
        (GobbettiCustom(degradation="areas / r"), r"degradation: .* did you mean area\?"),
        (GobbettiCustom(cost="open('x')"), "cost: expected one of sqrt"),
        (GobbettiCustom(max_iterations=0), r"max_iterations in \[1, inf\], got 0"),
    ],
)
def test_senseless_parameters_are_refused(
    crowd: Crowd, policy: GobbettiCustom, message: str
) -> None:
    """Formulas are read when the replay begins."""
    with pytest.raises(InputError, match=message):
        policy.reset(crowd().with_costs(COSTS), 4.0)


def test_an_empty_view_costs_the_frame(make_scene: MakeScene, make_view: MakeView) -> None:
    """Nothing in view: nothing to solve, and the base is predicted."""
    scene = make_scene([(0.0, 0.0, 50.0)]).with_costs(COSTS)
    policy = GobbettiCustom()
    policy.reset(scene, 4.0)
    selection = policy.select(make_view(scene))
    assert len(selection.ids) == 0
    assert selection.predicted_ms == 1.0


def test_reset_and_pickle_forget_nothing_else(crowd: Crowd, make_view: MakeView) -> None:
    """A second run after reset, and one of a pickled policy, equal the first."""
    scene = crowd().with_costs(COSTS)
    policy = GobbettiCustom()
    runs: list[list[FloatArray]] = []
    for _ in range(2):
        policy.reset(scene, 5.0)
        runs.append([policy.select(make_view(scene)).detail for _ in range(3)])
        policy = pickle.loads(pickle.dumps(policy))
    assert_array_equal(runs[0], runs[1])
    assert replace(policy, max_iterations=7).max_iterations == 7


def test_places_beyond_the_objects_change_nothing() -> None:
    """A program of 16 places and one of 64 find the same three resolutions."""
    values = np.array([[400.0, 20.0], [100.0, 10.0], [25.0, 5.0]])
    low = np.full(3, 0.05)
    start = Point(np.full(3, 0.5), np.zeros(3), 0.0)
    for places in (3, 16, 64):
        program = ConvexProgram("a / r", "c * r", ("a", "c"), places, 100)
        point = program.solve(values, low, 30.0, start, warm=False)
        assert point.failure is None
        assert_allclose(point.resolution, (1.0, 0.738796, 0.522408), atol=1e-5)
        assert point.budget_multiplier / 30.0 == pytest.approx(18.321068, rel=1e-5)
        again = program.solve(values, low, 30.0, point, warm=True)
        assert again.iterations < point.iterations


def test_the_example_of_the_manual_runs(
    crowd: Crowd, make_hardware: MakeHardware, tmp_path: Path
) -> None:
    """The class on the page, loaded as a user would, keeps its own budget without a failure."""
    found = re.search(r"```python file=(\w+\.py)\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert found is not None
    file = tmp_path / found[1]
    file.write_text(found[2], encoding="utf-8")
    policy = parse_policy(f"{file}:Blur:max_iterations=150").make()
    hardware = make_hardware({"triangles": 5e-5, "draw_calls": 5e-3})
    predicted_ms, charged_ms = log_columns(policy, crowd(), hardware).T
    assert (predicted_ms <= 4.0).all()
    assert (charged_ms > predicted_ms).all()  # it believes that coarse meshes are cheaper still
    assert isinstance(policy, GobbettiCustom)
    assert policy.failures == 0
