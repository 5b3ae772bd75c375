"""``gobbetti``: weights by hand, both engines, warm start, and whole replays."""

import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from lodbench.base.arrays import FloatArray
from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.camera import Camera
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.budgets.gobbetti import Gobbetti, eccentricity_weight, velocity_weight
from lodbench.policies.view import View
from lodbench.sim.frame_log import COUNTS, FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

MakeScene = Callable[..., Scene]
MakeLevels = Callable[..., LevelTable]
MakeView = Callable[..., View]
MakeHardware = Callable[..., HardwareProfile]
MakeTrace = Callable[..., CameraTrace]

LINEAR = CostModel.of(1.0, {"draw_calls": 1e-3, "triangles": 1e-4})
CHAINS = [(3000.0, 1500.0, 700.0, 100.0), (800.0, 300.0, 40.0), (500.0,)]


def column(log: FrameLog, name: str) -> FloatArray:
    """Return a count of every frame."""
    return log.counts[:, COUNTS.index(name)]


@pytest.fixture(name="crowd")
def fixture_crowd(make_scene: MakeScene, make_levels: MakeLevels) -> Callable[..., Scene]:
    """Build 120 objects of three types ahead of the camera, of which some come into view later."""

    def build(*, continuous: bool | list[bool] = True) -> Scene:
        rng = np.random.default_rng(7)
        x, y, z = rng.uniform(-40, 40, 120), rng.uniform(-10, 10, 120), rng.uniform(-90, -3, 120)
        return make_scene(
            np.stack((x, y, z), axis=1),
            kind=rng.integers(0, 3, 120),
            importance=rng.uniform(0.5, 2.0, 120),
            radius_m=(1.0, 0.7, 0.5),
            levels=make_levels(CHAINS, continuous=continuous),
        )

    return build


def test_velocity_weight_by_hand() -> None:
    """1 at rest, Reddy's logarithm in between, 0.1 of 60 cycles when fast; joins are smooth."""
    speed = np.array([0.0, 0.825, 1.0, 10.0, 118.3, 1000.0])
    expected = (1.0, 1.0, 57.69 / 60.0, 29.91 / 60.0, 0.1 / 60.0, 0.1 / 60.0)
    assert_allclose(velocity_weight(speed), expected, rtol=0.03)
    assert_allclose(velocity_weight(speed[2:4]), expected[2:4], rtol=1e-12)
    assert (np.diff(velocity_weight(np.linspace(0.0, 200.0, 500))) <= 0.0).all()


def test_eccentricity_weight_by_hand() -> None:
    """1 near the focus, 7.49 / 16 at 10 degrees, 7.49 / 100 at 30."""
    weight = eccentricity_weight(np.array([0.0, 5.7, 10.0, 30.0]))
    assert_allclose(weight, (1.0, 1.0, 7.49 / 16.0, 7.49 / 100.0), rtol=1e-12)


def test_degradation_by_hand(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """Importance times area over triangles, times acuity at the apparent speed and eccentricity."""
    levels = make_levels([(1000.0, 100.0), (200.0, 20.0)], continuous=True)
    scene = make_scene(
        [(0.0, 0.0, -10.0), (5.0, 0.0, -10.0)], kind=[0, 1], importance=[1.0, 3.0], levels=levels
    )
    view = make_view(scene)
    policy = Gobbetti()
    policy.reset(scene.with_costs(LINEAR), 10.0)
    angle = np.degrees(np.arctan(0.5))
    acuity = 7.49 / (0.3 * angle + 1.0) ** 2
    expected = view.area_px * (1.0 / 1000.0, 3.0 / 200.0 * acuity)
    assert_allclose(policy.degradation(view), expected, rtol=1e-12)
    plain = replace(policy, weight="area", eccentricity=False)
    plain.reset(scene.with_costs(LINEAR), 10.0)
    assert_allclose(plain.degradation(view), view.area_px * (1.0, 3.0), rtol=1e-12)
    before = Camera((0.1, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0), 100, 100, np.pi / 2)
    moving = make_view(scene, previous_camera=before, step_s=0.1)
    assert_allclose(
        policy.degradation(moving),
        expected * velocity_weight(moving.speed_deg_s),
        rtol=1e-12,
    )
    assert (moving.speed_deg_s > 1.0).all()


def test_three_objects_by_hand(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView
) -> None:
    """The closed form where no bound is in the way: r in proportion to the root of a over c."""
    levels = make_levels([(4000.0, 4.0), (2000.0, 2.0), (1000.0, 1.0)], continuous=True)
    position_m = [(0.0, 0.0, -10.0), (1.0, 0.0, -20.0), (1.0, 1.0, -40.0)]
    scene = make_scene(position_m, kind=[0, 1, 2], levels=levels).with_costs(LINEAR)
    view = make_view(scene)
    policy = Gobbetti(velocity=False, eccentricity=False)
    policy.reset(scene, 1.0 + 3e-3 + 0.2)
    selection = policy.select(view)
    full = np.array([4000.0, 2000.0, 1000.0])
    unit = np.sqrt(view.area_px / full / (1e-4 * full))
    expected = unit * 0.2 / (1e-4 * full @ unit)
    assert (expected < 1.0).all()
    assert_allclose(selection.detail, expected, rtol=1e-8)
    assert selection.predicted_ms == pytest.approx(1.203, rel=1e-8)
    assert selection.work.objects_visited == 3
    assert selection.work.comparisons == 6 * selection.work.iterations


@pytest.mark.parametrize("m", [1, 2])
@pytest.mark.parametrize("weight", ["area", "area-per-triangle"])
def test_engines_agree(
    crowd: Callable[..., Scene], make_view: MakeView, m: int, weight: str
) -> None:
    """Active set and Newton choose the same resolutions, for both exponents and weights."""
    scene = crowd().with_costs(LINEAR)
    detail: list[FloatArray] = []
    for engine in ("active-set", "newton"):
        policy = Gobbetti(m=m, weight=weight, engine=engine, max_iterations=10_000)  # pyright: ignore[reportArgumentType] - parametrised by strings
        policy.reset(scene, 8.0)
        detail.append(policy.select(make_view(scene)).detail)
    assert_allclose(detail[0], detail[1], rtol=1e-10)


@pytest.mark.parametrize("passes", [1, 2, 5, 20])
def test_stopped_early_it_keeps_the_budget(
    crowd: Callable[..., Scene], make_view: MakeView, passes: int
) -> None:
    """A work budget costs quality, never time; frame by frame the optimum is reached."""
    scene = crowd().with_costs(LINEAR)
    exact, policy = Gobbetti(engine="newton"), Gobbetti(max_iterations=passes)
    exact.reset(scene, 8.0)
    policy.reset(scene, 8.0)
    best = exact.select(make_view(scene)).detail
    frames = [policy.select(make_view(scene)) for _ in range(120)]
    for selection in frames:
        assert selection.predicted_ms <= 8.0
        assert selection.work.iterations <= passes
    if passes > 2:
        assert_allclose(frames[-1].detail, best, rtol=1e-10)


def test_over_budget_at_the_lowest_it_draws_the_lowest(
    crowd: Callable[..., Scene], make_view: MakeView
) -> None:
    """An infeasible budget gives each type's coarsest and an honest prediction above it."""
    scene = crowd().with_costs(LINEAR)
    view = make_view(scene)
    policy = Gobbetti()
    policy.reset(scene, 1.1)
    selection = policy.select(view)
    assert_array_equal(selection.detail, scene.types.levels.min_resolution[view.type_index])
    assert selection.predicted_ms > 1.1


def test_with_time_for_everything_it_draws_everything(
    crowd: Callable[..., Scene], make_view: MakeView
) -> None:
    """A generous budget gives resolution 1, exactly."""
    scene = crowd().with_costs(LINEAR)
    policy = Gobbetti()
    policy.reset(scene, 1000.0)
    assert_array_equal(policy.select(make_view(scene)).detail, 1.0)


@pytest.mark.parametrize("continuous", [True, False, [True, False, True]], ids=["r", "lod", "both"])
@pytest.mark.parametrize("policy", [Gobbetti(), Gobbetti(m=2, engine="newton")], ids=["as", "nt"])
@pytest.mark.parametrize(
    ("linear", "roofline"),
    [
        (
            {
                "triangles": 5e-5,
                "draw_calls": 5e-3,
                "shaded_samples": 1e-6,
                "framebuffer_pixels": 1e-5,
                "state_changes": 0.05,
            },
            {},
        ),
        ({"draw_calls": 5e-3}, {"triangles": 5e-5, "shaded_samples": 5e-5}),
        ({"triangles": 2e-5}, {"triangles": 5e-5, "shaded_samples": 5e-5}),
    ],
    ids=["linear", "roofline", "mixed"],
)
def test_replayed_end_to_end(
    crowd: Callable[..., Scene],
    make_hardware: MakeHardware,
    make_trace: MakeTrace,
    policy: Gobbetti,
    continuous: bool | list[bool],
    linear: dict[str, float],
    roofline: dict[str, float],
) -> None:
    """What is predicted is what is charged, never above the budget, and most of it is used."""
    hardware = make_hardware(linear, roofline=roofline)
    trace = make_trace([(0.0, 0.0, 0.0), (5.0, 1.0, -20.0), (-4.0, 0.0, -40.0)])
    options = ReplayOptions(budget_ms=4.0, frames=40)
    log = replay(policy, crowd(continuous=continuous), trace, hardware, options, name="gobbetti")
    predicted_ms = column(log, "predicted_gpu_ms")
    assert_allclose(predicted_ms, column(log, "model_gpu_ms"), rtol=1e-12)
    assert (predicted_ms <= 4.0).all()
    assert column(log, "full_gpu_ms").min() > 4.0
    if continuous is True:
        assert_allclose(predicted_ms, 4.0, rtol=1e-6)


def test_a_static_camera_reaches_a_fixed_point(
    crowd: Callable[..., Scene], make_view: MakeView
) -> None:
    """From the second frame on nothing changes, and a repeated frame takes few passes."""
    scene = crowd().with_costs(LINEAR)
    policy = Gobbetti(max_iterations=1000)
    policy.reset(scene, 8.0)
    first = policy.select(make_view(scene)).detail
    for _ in range(3):
        selection = policy.select(make_view(scene))
        assert_allclose(selection.detail, first, rtol=1e-12)
        assert selection.work.iterations <= 5


@pytest.mark.parametrize("engine", ["active-set", "newton"])
@pytest.mark.parametrize("m", [1, 2])
def test_hysteresis_is_the_optimum_with_a_kink(
    make_scene: MakeScene, make_levels: MakeLevels, make_view: MakeView, engine: str, m: int
) -> None:
    """Two objects on one budget, searched by brute force: what falls counts 1.3, what rises 0.7.

    A camera that hardly moves changes nothing, one that moves far something.
    """
    levels = make_levels([(4000.0, 40.0), (2000.0, 20.0)], continuous=True)
    scene = make_scene([(0.0, 0.0, -10.0), (1.0, 0.0, -12.0)], kind=[0, 1], levels=levels)
    scene = scene.with_costs(LINEAR)
    policy = Gobbetti(m=m, engine=engine, hysteresis=0.3, velocity=False)  # pyright: ignore[reportArgumentType] - parametrised by strings
    policy.reset(scene, 1.0 + 2e-3 + 0.3)
    last = policy.select(make_view(scene)).detail
    moved: list[bool] = []
    for z in (0.05, 0.1, -6.0, 6.0):
        camera = Camera((0.0, 0.0, z), (0.0, 0.0, 0.0, 1.0), 100, 100, np.pi / 2)
        view = make_view(scene, camera)
        detail = policy.select(view).detail
        first = np.linspace(0.011, min(1.0, 0.3 / 0.4), 20_001)
        both = np.stack((first, (0.3 - 0.4 * first) / 0.2), axis=1)
        both = both[(both[:, 1] >= 0.01) & (both[:, 1] <= 1.0)]
        worse = both ** -float(m) - last ** -float(m)
        sums = (both ** -float(m) + 0.3 * np.abs(worse)) @ policy.degradation(view)
        assert_allclose(detail, both[int(sums.argmin())], atol=3e-4)
        assert 0.4 * detail[0] + 0.2 * detail[1] == pytest.approx(0.3, rel=1e-6)
        moved.append(bool(np.abs(detail - last).max() > 1e-12))
        last = detail
    assert moved == [False, False, True, True]


def test_hysteresis_changes_fewer_levels_within_the_same_budget(
    crowd: Callable[..., Scene], make_hardware: MakeHardware, make_trace: MakeTrace
) -> None:
    """On a walk through 120 objects, and full time is used all the same."""
    hardware = make_hardware({"triangles": 5e-5, "draw_calls": 5e-3})
    trace = make_trace([(0.0, 0.0, 0.0), (1.0, 1.0, -4.0), (0.0, 0.0, -8.0)])
    options = ReplayOptions(budget_ms=4.0, frames=60)
    extracted: list[float] = []
    for hysteresis in (0.0, 0.2):
        policy = Gobbetti(hysteresis=hysteresis)
        log = replay(policy, crowd(), trace, hardware, options, name="gobbetti")
        assert (column(log, "model_gpu_ms") <= 4.0).all()
        assert column(log, "model_gpu_ms").min() > 3.99
        extracted.append(column(log, "levels_extracted")[1:].mean())
    assert extracted[1] < 0.8 * extracted[0]


def test_what_comes_ahead_of_drawing_has_its_share(
    crowd: Callable[..., Scene], make_hardware: MakeHardware, make_trace: MakeTrace
) -> None:
    """Of 4 ms a fifth comes ahead, 3.2 are drawn; a CPU that takes 1.5 leaves 2.5 for drawing."""
    trace = make_trace([(0.0, 0.0, 0.0), (5.0, 1.0, -20.0)])
    options = ReplayOptions(budget_ms=4.0, frames=20)
    for cpu_ms, drawn_ms in ((0.1, 3.2), (1.5, 2.5)):
        hardware = make_hardware({"triangles": 5e-5, "draw_calls": 5e-3}, cpu_base_ms=cpu_ms)
        log = replay(Gobbetti(ahead=0.2), crowd(), trace, hardware, options, name="gobbetti")
        assert_allclose(column(log, "model_gpu_ms")[5:], drawn_ms, rtol=1e-6)


def test_reset_forgets(crowd: Callable[..., Scene], make_view: MakeView) -> None:
    """A second run after reset, or from a pickle, equals the first, stopped early or not."""
    scene = crowd().with_costs(LINEAR)
    policy = Gobbetti(max_iterations=3)
    runs: list[list[FloatArray]] = []
    for _ in range(2):
        policy.reset(scene, 8.0)
        runs.append([policy.select(make_view(scene)).detail for _ in range(4)])
        policy = pickle.loads(pickle.dumps(policy))
    assert_array_equal(runs[0], runs[1])


@pytest.mark.parametrize("policy", [Gobbetti(m=3), Gobbetti(max_iterations=0)])
def test_senseless_parameters_are_refused(crowd: Callable[..., Scene], policy: Gobbetti) -> None:
    """Exponents other than 1 and 2, and no pass at all."""
    with pytest.raises(InputError, match=r"gobbetti: expected (m|max_iterations) in .*, got [30]"):
        policy.reset(crowd().with_costs(LINEAR), 8.0)
