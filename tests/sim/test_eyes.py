"""Replays that two eyes look at: what they cost beside one camera, and how they are judged."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.base.predictors import GPU_PREDICTORS, LEVEL_PREDICTORS
from lodbench.models.machine.cost_terms.catalog import FRAME_TERMS
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.rig import Eyes
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.protocol import Policy
from lodbench.policies.registry import parse_policy
from lodbench.policies.selection import Selection
from lodbench.policies.view import View
from lodbench.sim.frame_log import UNLOGGED, FrameLog
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]
MakeHardware = Callable[..., HardwareProfile]

EYES = Eyes(apart_m=0.0)
AT_ONCE = Eyes(apart_m=0.0, single_pass=True)

ROW = [(0.4 * x, 0.3 * x, -6.0 - 2.0 * x) for x in range(6)]
KIND = [0, 1, 0, 1, 0, 0]
LEVELS = [(1000, 250), (600, 20)]
SHOWN = ("visible", "drawn", "missing", "toggles", "visible_pops", "popping_px", "sse_px_p95")
PRICED = {
    "draw_calls": 0.01,
    "triangles": 1e-3,
    "rasterized_triangles": 2e-3,
    "triangles_in_view": 1e-3,
    "shaded_samples": 1e-3,
    "state_changes": 0.25,
    "framebuffer_pixels": 1e-4,
}


@pytest.fixture
def look(
    run: Run, scripted: MakePolicy, make_levels: Callable[..., LevelTable]
) -> Callable[..., FrameLog]:
    """Return a function that draws six objects of two types, whose levels change once."""
    script = scripted([[0, 1, 0, 0, 1, 0], [1, 1, 0, 1, 1, 0]])

    def looked(hardware: HardwareProfile, eyes: Eyes | None = None, **options: Any) -> FrameLog:
        return run(
            script,
            2,
            positions=ROW,
            kind=KIND,
            levels=make_levels(LEVELS),
            hardware=hardware,
            options={"eyes": eyes, **options},
        )

    return looked


@pytest.mark.parametrize("roofline", [None, {"triangles": 1e-3, "shaded_samples": 1e-3}])
def test_two_eyes_at_one_place_cost_twice_what_one_camera_draws(
    look: Callable[..., FrameLog], make_hardware: MakeHardware, roofline: dict[str, float] | None
) -> None:
    """Every count doubles but those of what is new, of which there is one copy; so do the costs."""
    one = look(make_hardware(PRICED, roofline=roofline, width_px=50))
    two = look(make_hardware(PRICED, roofline=roofline), EYES)
    new = {name for name, term in FRAME_TERMS.items() if term.of_changes}
    for name in set(GPU_PREDICTORS) - {*UNLOGGED} - new:
        np.testing.assert_allclose(two[name], 2.0 * one[name], rtol=1e-12, err_msg=name)
    for name in new:
        assert two[name].tolist() == one[name].tolist()
    for name in ("model_gpu_ms", "full_gpu_ms"):
        np.testing.assert_allclose(two[name] - 1.0, 2.0 * (one[name] - 1.0), rtol=1e-12)
    assert two["model_gpu_ms"][0] > 2.0


def test_two_eyes_at_one_place_see_what_one_camera_sees(
    look: Callable[..., FrameLog], make_hardware: MakeHardware
) -> None:
    """Nothing is judged worse, or as more, for being shown twice."""
    one = look(make_hardware(PRICED, width_px=50), visible_px=0.1)
    for eyes in (EYES, AT_ONCE):
        two = look(make_hardware(PRICED), eyes, visible_px=0.1)
        for name in (*SHOWN, "sse_px_max", "visible_error_area_px"):
            np.testing.assert_allclose(two[name], one[name], rtol=1e-12, err_msg=name)
        for share in ("benefit", "degradation"):
            of_one, of_two = (log[share] / log[f"full_{share}"] for log in (one, two))
            np.testing.assert_allclose(of_two, of_one, rtol=1e-12)
    assert one["popping_px"][1] > 0.0
    assert one["visible_error_area_px"][0] > 0.0


def test_a_single_pass_costs_what_one_camera_costs_but_for_pixels(
    look: Callable[..., FrameLog], make_hardware: MakeHardware
) -> None:
    """Draw calls, triangles and types are submitted once for both; samples are shaded twice."""
    submitted = {"draw_calls": 0.01, "triangles": 1e-3, "state_changes": 0.25}
    one = look(make_hardware(submitted, width_px=50))
    two = look(make_hardware(submitted), AT_ONCE)
    assert two["model_gpu_ms"].tolist() == one["model_gpu_ms"].tolist()
    for name in set(LEVEL_PREDICTORS) | {"state_changes"}:
        assert two[name].tolist() == one[name].tolist()
    shaded = {"shaded_samples": 1e-3, "framebuffer_pixels": 1e-4, "rasterized_triangles": 2e-3}
    one = look(make_hardware(shaded, width_px=50))
    two = look(make_hardware(shaded), AT_ONCE)
    np.testing.assert_allclose(
        two["model_gpu_ms"] - 1.0, 2.0 * (one["model_gpu_ms"] - 1.0), rtol=1e-12
    )


def test_what_one_eye_sees_is_drawn_once(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware
) -> None:
    """Of eyes 1 m apart whose pictures end at half the depth, the left reaches 0.1 m beyond 5.5 m.

    There a ball of 0.2 m, at -5.6 m, is in its picture and far out of the right one's; one in the
    middle is in both.  Distances are those of the nearest eye that sees a ball.
    """
    seen: list[View] = []

    def watch(view: View, selection: Selection) -> Selection:
        seen.append(view)
        return selection

    log = run(
        scripted([0], watch),
        positions=[(-5.6, 0.0, -10.0), (0.2, 0.0, -10.0)],
        radius_m=0.2,
        hardware=make_hardware({"draw_calls": 0.1}),
        options={"eyes": Eyes(apart_m=1.0)},
    )
    assert log["visible"][0] == 2
    assert log["draw_calls"][0] == 3
    assert log["triangles"][0] == 3000
    assert log["model_gpu_ms"][0] == pytest.approx(1.0 + 0.3)
    (view,) = seen
    assert view.distance_m == pytest.approx([np.hypot(5.1, 10.0), np.hypot(0.3, 10.0)])
    assert view.camera.position_m == (0.0, 0.0, 0.0)
    assert view.viewport_px == 100 * 100
    left, right = (camera.position_m for camera in view.state.rig.cameras)  # pyright: ignore[reportOptionalMemberAccess]
    assert (left, right) == ((-0.5, 0.0, 0.0), (0.5, 0.0, 0.0))


def test_the_error_is_that_of_the_nearer_eye(run: Run, scripted: MakePolicy) -> None:
    """A level that errs by 0.1 m, 9 m from the surface's nearest point to the right eye.

    The ball of 1 m is straight before that eye, at 10 m; the lens has 50 px of focal length.
    """
    log = run(scripted([1]), positions=[(0.5, 0.0, -10.0)], options={"eyes": Eyes(apart_m=1.0)})
    assert log["sse_px_max"][0] == pytest.approx(0.1 * 50.0 / 9.0)


@pytest.mark.parametrize("size", [(50, 100), (200, 80)])
def test_each_eye_has_a_picture_of_its_own(
    run: Run, make_hardware: MakeHardware, size: tuple[int, int]
) -> None:
    """The framebuffer is both pictures, half of the display each unless told."""
    hardware = make_hardware({"framebuffer_pixels": 1e-4})
    given = None if size == (50, 100) else size
    log = run(Full(), hardware=hardware, options={"eyes": Eyes(apart_m=0.1, size_px=given)})
    assert log["model_gpu_ms"][0] == pytest.approx(1.0 + 1e-4 * 2 * size[0] * size[1])


@pytest.mark.parametrize("policy", ["gobbetti", "zach", "funkhouser", "maciel", "mason-blake"])
@pytest.mark.parametrize("roofline", [None, {"triangles": 1e-3, "shaded_samples": 2e-3}])
@pytest.mark.parametrize("single_pass", [False, True])
def test_policies_that_predict_know_how_often_objects_are_drawn(
    run: Run,
    make_levels: Callable[..., LevelTable],
    make_hardware: MakeHardware,
    policy: str,
    roofline: dict[str, float] | None,
    single_pass: bool,
) -> None:
    """Seven objects, some of which one eye sees alone: predicted is what the frame then costs."""
    eyes = Eyes(apart_m=1.0, single_pass=single_pass)
    positions = [*ROW, (-5.6, 0.0, -10.0)]
    log = run(
        parse_policy(policy).make(),
        3,
        positions=positions,
        kind=[*KIND, 1],
        radius_m=0.2,
        levels=make_levels(LEVELS, draw_calls=1.0),
        hardware=make_hardware(PRICED, roofline=roofline),
        options={"eyes": eyes, "budget_ms": 9.0},
    )
    predicted, true = log["predicted_gpu_ms"], log["model_gpu_ms"]
    if policy in {"maciel", "mason-blake"}:  # an upper bound as to types that are not drawn
        assert (predicted >= true * (1.0 - 1e-12)).all()
        assert (predicted <= true + 1.0).all()
    else:
        np.testing.assert_allclose(predicted, true, rtol=1e-12)
    drawn = len(positions) if single_pass else 2 * len(positions) - 1
    assert log["draw_calls"].tolist() == [drawn] * 3


def test_no_selection_is_better_than_the_bound_of_two_eyes(
    run: Run, make_levels: Callable[..., LevelTable], make_hardware: MakeHardware
) -> None:
    """The bound counts types and draws as the frame does, or the oracle would be above it."""
    log = run(
        parse_policy("oracle").make(),
        positions=[*ROW, (-5.6, 0.0, -10.0)],
        kind=[*KIND, 1],
        radius_m=0.2,
        levels=make_levels(LEVELS),
        hardware=make_hardware(PRICED),
        options={"eyes": Eyes(apart_m=1.0), "budget_ms": 9.0},
    )
    assert log["model_gpu_ms"][0] <= 9.0
    assert log["benefit"][0] <= log["benefit_bound"][0] * (1.0 + 1e-12)
    assert log["benefit"][0] >= 0.9 * log["benefit_bound"][0]


def test_a_tree_is_drawn_by_both_eyes(
    make_styria: Callable[..., Scene],
    make_hardware: MakeHardware,
    make_trace: Callable[..., CameraTrace],
) -> None:
    """Two eyes at one place draw a hierarchy's front twice, switch it once, and err as one does."""
    scene = make_styria()
    middle = scene.center_m.mean(axis=1)
    trace = make_trace([(middle[0], middle[1], 800.0), (middle[0] + 300.0, middle[1], 60.0)])
    logs = [
        replay(
            parse_policy("screen-space-error").make(),
            scene,
            trace,
            make_hardware({}, width_px=width, frames_in_flight=1, base_ms=20.0),
            ReplayOptions(budget_ms=10.0, fovy_deg=90.0, frames=40, eyes=eyes),
            name="sse",
        )
        for width, eyes in ((50, None), (100, EYES))
    ]
    one, two = logs
    np.testing.assert_allclose(two["triangles"], 2.0 * one["triangles"], rtol=1e-12)
    assert one["triangles"].max() > 0.0
    assert one["toggles"].sum() > 0
    for name in SHOWN:
        np.testing.assert_allclose(two[name], one[name], rtol=1e-9, err_msg=name)


def test_fading_levels_are_drawn_by_both_eyes(
    look: Callable[..., FrameLog], make_hardware: MakeHardware
) -> None:
    """A level that fades out costs each eye what it costs one camera."""
    one = look(make_hardware(PRICED, width_px=50), crossfade_ms=500.0)
    two = look(make_hardware(PRICED), EYES, crossfade_ms=500.0)
    assert one["fading"].tolist() == two["fading"].tolist() == [0.0, 2.0]
    np.testing.assert_allclose(
        two["model_gpu_ms"] - 1.0, 2.0 * (one["model_gpu_ms"] - 1.0), rtol=1e-12
    )


@pytest.mark.parametrize("apart_m", [-0.1, 64.0, float("nan")])
def test_eyes_that_no_head_has_are_refused(apart_m: float) -> None:
    """Millimetres in place of metres would give a giant's view, and cull nothing."""
    with pytest.raises(InputError, match="expected metres between the eyes from 0 to 1"):
        Eyes(apart_m=apart_m)
