"""``wimmer``: the closed form by hand, what clamping does, and whole replays."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.gobbetti import Gobbetti
from lodbench.policies.budgets.wimmer import Wimmer
from lodbench.policies.view import View
from lodbench.sim.frame_log import COUNTS
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]
MakeView = Callable[..., View]
MakeHardware = Callable[..., HardwareProfile]
MakeTrace = Callable[..., CameraTrace]

COSTS = CostModel.of(1.0, {"triangles": 1e-3})
PLACES = [(0.0, 0.0, -10.0), (1.0, 0.0, -20.0), (1.0, 1.0, -40.0)]


@pytest.mark.parametrize("m", [1, 2])
def test_triangles_are_shared_by_area(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView, m: int
) -> None:
    """In proportion to (importance · area)^(1 / (m + 1)), whatever the meshes."""
    chains = [(900.0, 1.0), (800.0, 1.0), (700.0, 1.0)]
    scene = make_scene(
        PLACES,
        kind=[0, 1, 2],
        importance=[1.0, 2.0, 1.0],
        levels=make_levels(chains, continuous=True),
    ).with_costs(COSTS)
    view = make_view(scene)
    policy = Wimmer(m=m)
    policy.reset(scene, 1.5)
    selection = policy.select(view)
    share = (view.area_px * (1.0, 2.0, 1.0)) ** (1.0 / (m + 1))
    triangles = 500.0 * share / share.sum()
    assert_allclose(selection.detail * (900.0, 800.0, 700.0), triangles, rtol=1e-8)
    assert selection.predicted_ms == pytest.approx(1.5, rel=1e-8)
    assert selection.work.iterations == 1


def test_what_clamping_frees_stays_unspent(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """A near object with fewer triangles than its share: the others get no more; Gobbetti's do."""
    chains = [(100.0, 1.0), (800.0, 1.0), (700.0, 1.0)]
    levels = make_levels(chains, continuous=True)
    scene = make_scene(PLACES, kind=[0, 1, 2], levels=levels).with_costs(COSTS)
    view = make_view(scene)
    policy, bounded = Wimmer(), Gobbetti(velocity=False, eccentricity=False)
    policy.reset(scene, 1.5)
    bounded.reset(scene, 1.5)
    selection, filled = policy.select(view), bounded.select(view)
    share = np.sqrt(view.area_px)
    triangles = 500.0 * share / share.sum()
    assert triangles[0] > 100.0
    assert selection.detail[0] == 1.0
    assert_allclose(selection.detail[1:] * (800.0, 700.0), triangles[1:], rtol=1e-8)
    assert selection.predicted_ms == pytest.approx(1.5 - 1e-3 * (triangles[0] - 100.0), rel=1e-8)
    assert filled.predicted_ms == pytest.approx(1.5, rel=1e-8)
    assert (filled.detail[1:] > selection.detail[1:]).all()


def test_raising_to_the_coarsest_lowers_the_others(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """Far objects whose coarsest level is above their share are paid for by the near one."""
    levels = make_levels([(900.0, 1.0), (800.0, 150.0)], continuous=True)
    scene = make_scene(PLACES, kind=[0, 1, 1], levels=levels).with_costs(COSTS)
    policy = Wimmer()
    policy.reset(scene, 1.4)
    selection = policy.select(make_view(scene))
    assert_allclose(selection.detail * (900.0, 800.0, 800.0), (100.0, 150.0, 150.0), rtol=1e-5)
    assert selection.predicted_ms <= 1.4


def test_infeasible_and_generous_budgets(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """Below the coarsest all are coarsest; with endless time all are full."""
    scene = make_scene(PLACES, levels=make_levels(continuous=True)).with_costs(COSTS)
    policy = Wimmer()
    for budget_ms, resolution in ((0.5, 0.05), (1.1, 0.05), (1e6, 1.0)):
        policy.reset(scene, budget_ms)
        assert_array_equal(policy.select(make_view(scene)).detail, resolution)


@pytest.mark.parametrize("continuous", [True, False, [True, False]], ids=["r", "lod", "both"])
@pytest.mark.parametrize("roofline", [{}, {"triangles": 5e-5, "shaded_samples": 5e-5}])
def test_replayed_end_to_end(
    make_scene: MakeScene,
    make_levels: MakeLevels,
    make_hardware: MakeHardware,
    make_trace: MakeTrace,
    continuous: bool | list[bool],
    roofline: dict[str, float],
) -> None:
    """What is predicted is what is charged, and never above the budget."""
    rng = np.random.default_rng(3)
    levels = make_levels([(3000.0, 700.0, 100.0), (800.0, 300.0, 40.0)], continuous=continuous)
    position_m = np.column_stack((rng.uniform(-20, 20, (90, 2)), rng.uniform(-80, -3, 90)))
    scene = make_scene(position_m, kind=rng.integers(0, 2, 90), levels=levels)
    hardware = make_hardware({"triangles": 2e-5, "draw_calls": 5e-3}, roofline=roofline)
    trace = make_trace([(0.0, 0.0, 0.0), (2.0, 0.0, -30.0)])
    options = ReplayOptions(budget_ms=3.0, frames=30)
    log = replay(Wimmer(), scene, trace, hardware, options, name="wimmer")
    predicted_ms = log.counts[:, COUNTS.index("predicted_gpu_ms")]
    charged_ms = log.counts[:, COUNTS.index("model_gpu_ms")]
    assert_allclose(predicted_ms, charged_ms, rtol=1e-12)
    assert (predicted_ms <= 3.0).all()


def test_a_senseless_exponent_is_refused(make_scene: MakeScene) -> None:
    """The exponent is 1 or 2."""
    with pytest.raises(InputError, match=r"wimmer: expected m in \[1, 2\], got 0"):
        Wimmer(m=0).reset(make_scene(PLACES).with_costs(COSTS), 2.0)
