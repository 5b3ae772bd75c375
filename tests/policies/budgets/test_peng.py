"""``peng``: the published share by hand, both modes, the threshold, and whole replays."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from lodbench.base.errors import InputError
from lodbench.base.predictors import LEVEL_PREDICTORS
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.peng import Peng
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

VERTICES = LEVEL_PREDICTORS.index("vertices")
COSTS = CostModel.of(1.0, {"triangles": 1e-3})
PLACES = [(0.0, 0.0, -10.0), (1.0, 0.0, -20.0), (1.0, 1.0, -40.0)]


@pytest.mark.parametrize("alpha", [1.0, 2.0, 3.0, 5.0])
@pytest.mark.parametrize("mode", ["clipped", "water-filled"])
def test_equation_1(
    make_scene: MakeScene,
    make_levels: MakeLevels,
    make_view: MakeView,
    alpha: float,
    mode: str,
) -> None:
    """N A^(1/α) / Σ A^(1/α) primitives, N being what the time pays for; importance is not asked."""
    levels = make_levels([(2620.0, 1.0), (1642.0, 1.0)], continuous=True)
    scene = make_scene(PLACES, kind=[0, 1, 0], importance=[1.0, 9.0, 1.0], levels=levels)
    scene = scene.with_costs(COSTS)
    view = make_view(scene)
    policy = Peng(alpha=alpha, mode=mode)  # pyright: ignore[reportArgumentType] - parametrised by strings
    policy.reset(scene, 2.0)
    selection = policy.select(view)
    share = view.area_px ** (1.0 / alpha)
    primitives = 1000.0 * share / share.sum()
    assert_allclose(selection.detail * (2620.0, 1642.0, 2620.0), primitives, rtol=1e-8)


@pytest.mark.parametrize("mode", ["clipped", "water-filled"])
def test_n_is_shared_in_vertices_and_mapped_to_triangles(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView, mode: str
) -> None:
    """Of 1,000 vertices at 2,620 triangles, 400 at 655 and 160 at 190; time is not asked."""
    levels = make_levels([(2620.0, 655.0, 190.0)], continuous=True)
    counts = levels.counts.copy()
    counts[:, VERTICES] = 1000.0, 400.0, 160.0
    levels = replace(levels, counts=counts)
    scene = make_scene(PLACES, levels=levels).with_costs(COSTS)
    view = make_view(scene)
    share = np.cbrt(view.area_px)
    policy = Peng(vertices=900, mode=mode)  # pyright: ignore[reportArgumentType] - parametrised by strings
    policy.reset(scene, 1e-6)
    vertices = 900.0 * share / share.sum()
    assert vertices[0] > 400.0 > vertices[1] > vertices[2] > 160.0  # on either side of a knot
    at, has = np.array([160.0, 400.0, 1000.0]), np.array([190.0, 655.0, 2620.0])
    wanted: list[float] = vertices.tolist()
    triangles = np.array([float(np.interp(count, at, has)) for count in wanted])
    selection = policy.select(view)
    assert_allclose(selection.detail * 2620.0, triangles, rtol=1e-8)
    assert selection.predicted_ms == pytest.approx(1.0 + 1e-3 * triangles.sum(), rel=1e-8)
    assert policy.claims.budget is False


def test_n_modes_differ_where_a_character_has_less_than_its_share(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """The near one is full; what it cannot use is lost, or shared by the others."""
    levels = make_levels([(1000.0, 10.0)], continuous=True)
    counts = levels.counts.copy()
    counts[:, VERTICES] = 1000.0, 10.0
    scene = make_scene(PLACES, levels=replace(levels, counts=counts)).with_costs(COSTS)
    view = make_view(scene)
    share = np.cbrt(view.area_px)
    for mode, others in (
        ("clipped", 2400.0 * share[1:] / share.sum()),
        ("water-filled", 1400.0 * share[1:] / share[1:].sum()),
    ):
        policy = Peng(vertices=2400, mode=mode)  # pyright: ignore[reportArgumentType]
        policy.reset(scene, 9.0)
        detail = policy.select(view).detail
        assert detail[0] == 1.0
        assert_allclose(1000.0 * detail[1:], others, rtol=1e-8)


def test_modes_differ_where_a_character_has_less_than_its_share(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """Clipped leaves what the near one cannot use; water-filled shares it as equation 1 does."""
    levels = make_levels([(100.0, 1.0), (2000.0, 1.0)], continuous=True)
    scene = make_scene(PLACES, kind=[0, 1, 1], levels=levels).with_costs(COSTS)
    view = make_view(scene)
    share = np.cbrt(view.area_px)
    clipped, filled = Peng(), Peng(mode="water-filled")
    for policy, primitives in (
        (clipped, 1000.0 * share / share.sum()),
        (filled, 900.0 * share / share[1:].sum()),
    ):
        policy.reset(scene, 2.0)
        selection = policy.select(view)
        assert selection.detail[0] == 1.0
        assert_allclose(selection.detail[1:] * 2000.0, primitives[1:], rtol=1e-8)
    assert clipped.select(view).predicted_ms < 1.9
    assert filled.select(view).predicted_ms == pytest.approx(2.0, rel=1e-8)


@pytest.mark.parametrize("m", [1, 2])
def test_alpha_m_plus_1_is_wimmer(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView, m: int
) -> None:
    """With equal importance and cost by triangles the two policies choose the same."""
    levels = make_levels([(2620.0, 30.0), (1642.0, 20.0)], continuous=True)
    scene = make_scene(PLACES, kind=[0, 1, 0], levels=levels).with_costs(COSTS)
    peng, wimmer = Peng(alpha=m + 1.0), Wimmer(m=m)
    for budget_ms in (1.1, 2.0, 4.0):
        peng.reset(scene, budget_ms)
        wimmer.reset(scene, budget_ms)
        view = make_view(scene)
        assert_allclose(peng.select(view).detail, wimmer.select(view).detail, rtol=1e-12)


def test_below_the_threshold_nothing_is_drawn(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """The farthest is left out, and its share goes to the others."""
    levels = make_levels([(2620.0, 1.0)], continuous=True)
    scene = make_scene(PLACES, levels=levels).with_costs(COSTS)
    view = make_view(scene)
    policy = Peng(threshold_px=float(view.area_px[1]))
    policy.reset(scene, 2.0)
    selection = policy.select(view)
    assert selection.ids.tolist() == [0, 1]
    assert float(selection.detail.sum()) * 2620.0 == pytest.approx(1000.0, rel=1e-8)
    nobody = Peng(threshold_px=1e9)
    nobody.reset(scene, 2.0)
    assert len(nobody.select(view).ids) == 0
    assert nobody.select(view).predicted_ms == 1.0


def test_infeasible_and_generous_budgets(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """Below the coarsest all are coarsest; with endless time all are full."""
    scene = make_scene(PLACES, levels=make_levels(continuous=True)).with_costs(COSTS)
    for policy in (Peng(), Peng(mode="water-filled")):
        for budget_ms, resolution in ((0.5, 0.05), (1e6, 1.0)):
            policy.reset(scene, budget_ms)
            assert_array_equal(policy.select(make_view(scene)).detail, resolution)


@pytest.mark.parametrize("continuous", [True, False], ids=["r", "lod"])
@pytest.mark.parametrize(
    "policy", [Peng(), Peng(mode="water-filled"), Peng(threshold_px=8.0)], ids=["c", "w", "t"]
)
def test_replayed_end_to_end(
    make_scene: MakeScene,
    make_levels: MakeLevels,
    make_hardware: MakeHardware,
    make_trace: MakeTrace,
    policy: Peng,
    continuous: bool,
) -> None:
    """Peng's character in a crowd: predicted is charged, within the budget, small ones missing."""
    rng = np.random.default_rng(3)
    chain = (2620.0, 655.0, 388.0, 276.0, 190.0)
    position_m = np.column_stack((rng.uniform(-20, 20, (90, 2)), rng.uniform(-80, -3, 90)))
    scene = make_scene(position_m, levels=make_levels([chain], continuous=continuous))
    hardware = make_hardware({"triangles": 2.93e-5}, base_ms=1.738)
    trace = make_trace([(0.0, 0.0, 0.0), (2.0, 0.0, -30.0)])
    options = ReplayOptions(budget_ms=4.0, frames=30)
    log = replay(policy, scene, trace, hardware, options, name="peng")
    predicted_ms = log.counts[:, COUNTS.index("predicted_gpu_ms")]
    charged_ms = log.counts[:, COUNTS.index("model_gpu_ms")]
    assert_allclose(predicted_ms, charged_ms, rtol=1e-12)
    assert (predicted_ms <= 4.0).all()
    missing = log.counts[:, COUNTS.index("missing")]
    assert bool(missing.any()) == (policy.threshold_px > 0.0)
    if policy.mode == "water-filled" and continuous:
        assert_allclose(predicted_ms, 4.0, rtol=1e-6)


@pytest.mark.parametrize("policy", [Peng(alpha=0.0), Peng(alpha=50.0), Peng(threshold_px=-1.0)])
def test_senseless_parameters_are_refused(make_scene: MakeScene, policy: Peng) -> None:
    """An exponent that leaves nothing to share by, and a negative area."""
    with pytest.raises(InputError, match=r"peng: expected (alpha|threshold_px) in .*, got"):
        policy.reset(make_scene(PLACES).with_costs(COSTS), 2.0)
