"""What a frame draws, costs and shows: one to five objects worked out by hand."""

import math
from collections.abc import Callable

import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.policies.bounds.full import Full
from lodbench.policies.protocol import Policy
from lodbench.policies.selection import Work
from lodbench.sim.frame_log import FrameLog

AREA_PX = math.pi * 50.0**2 / 99.0  # of a sphere of 1 m at 10 m, 100 px high at 90 degrees
UNIT_PX = 50.0 / 9.0  # of 1 m at its nearest point, 9 m away
VIEWPORT_PX = 100.0 * 100.0
Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]
MakeLevels = Callable[..., LevelTable]
MakeHardware = Callable[..., HardwareProfile]


def test_full_detail_of_one_object(run: Run) -> None:
    """1,000 triangles in one call cover the sphere's ellipse; 1 ms and 1 us a triangle are 2 ms."""
    log = run(Full())
    expected = {
        "triangles": 1000, "draw_calls": 1, "shaded_samples": AREA_PX, "state_changes": 1,
        "visible": 1, "drawn": 1, "missing": 0, "fading": 0, "toggles": 0, "reversals": 0,
        "gpu_ms": 2.0, "model_gpu_ms": 2.0, "full_gpu_ms": 2.0, "cpu_ms": 0.5,
        "sse_px_p95": 0.0, "sse_px_max": 0.0, "popping_px": 0.0,
        "benefit": AREA_PX * (1 - 0.5 / 1000), "full_benefit": AREA_PX * (1 - 0.5 / 1000),
        "degradation": AREA_PX / 1000, "full_degradation": AREA_PX / 1000,
        "x_m": 0.0, "y_m": 0.0, "z_m": 0.0,
    }  # fmt: skip
    assert {name: float(log[name][0]) for name in expected} == pytest.approx(expected)
    assert math.isnan(log["predicted_gpu_ms"][0])
    assert log.times_ns.tolist() == [[0, 500_000, 500_000, 2_500_000, 2_500_000]]


def test_a_coarse_level_of_one_object(run: Run, scripted: MakePolicy) -> None:
    """Level 2 draws 50 triangles with 0.2 m of error, seen from 9 m."""
    log = run(scripted([2]))
    expected = {
        "triangles": 50, "gpu_ms": 1.05, "full_gpu_ms": 2.0,
        "sse_px_p95": 0.2 * UNIT_PX, "sse_px_max": 0.2 * UNIT_PX,
        "benefit": AREA_PX * 0.99, "degradation": AREA_PX / 50,
    }  # fmt: skip
    assert {name: float(log[name][0]) for name in expected} == pytest.approx(expected)


def test_visible_error_is_weighed_by_area(run: Run, scripted: MakePolicy) -> None:
    """At 10 m 0.2 m of error are 1.11 px, at 20 m 0.1 m are 0.26 px: above 1 px the near one alone.

    Of both areas together the near one has 399 / (399 + 99).
    """
    places = [(0.0, 0.0, -10.0), (0.0, 0.0, -20.0)]
    log = run(scripted([[2, 1]]), positions=places)
    near = 399.0 / (399.0 + 99.0)
    assert log["visible_error_area_px"][0] == pytest.approx(near * (0.2 * UNIT_PX - 1.0))
    log = run(scripted([[2, 1]]), positions=places, options={"visible_px": 0.1})
    far_px = 0.1 * 50.0 / 19.0
    expected = near * (0.2 * UNIT_PX - 0.1) + (1.0 - near) * (far_px - 0.1)
    assert log["visible_error_area_px"][0] == pytest.approx(expected)
    assert not run(scripted([1]), options={"visible_px": 0.56})["visible_error_area_px"].any()


def test_scale_and_importance_count(run: Run, scripted: MakePolicy) -> None:
    """At twice the size and 20 m the area is the same; error and weights double."""
    log = run(scripted([1]), positions=[(0.0, 0.0, -20.0)], scale=2.0, importance=3.0)
    assert log["shaded_samples"][0] == pytest.approx(AREA_PX)
    assert log["sse_px_max"][0] == pytest.approx(0.1 * 2.0 * 50.0 / 18.0)
    assert log["benefit"][0] == pytest.approx(3.0 * AREA_PX * (1 - 0.5 / 250))


def test_five_objects_of_two_types(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels, make_hardware: MakeHardware
) -> None:
    """Counts add up over objects; a type is one state change however often it is drawn."""
    levels = make_levels([(1000, 250), (60, 20)], draw_calls=2.0)
    hardware = make_hardware({"triangles": 1e-3, "draw_calls": 0.01, "state_changes": 0.25})
    log = run(
        scripted([[0, 1, 1, 0, 1]]),
        positions=[(x, 0.0, -10.0) for x in (-2.0, -1.0, 0.0, 1.0, 2.0)],
        kind=[0, 0, 1, 1, 1], levels=levels,
        hardware=hardware,
    )  # fmt: skip
    assert log["triangles"][0] == 1000 + 250 + 20 + 60 + 20
    assert log["draw_calls"][0] == 10
    assert log["state_changes"][0] == 2
    assert log["model_gpu_ms"][0] == pytest.approx(1.0 + 1.35 + 0.1 + 0.5)
    assert log["full_gpu_ms"][0] == pytest.approx(1.0 + 2.18 + 0.1 + 0.5)


def test_objects_outside_the_frustum_cost_nothing(run: Run) -> None:
    """Of three objects, one behind and one far aside, the simulator counts one."""
    positions = [(0.0, 0.0, 10.0), (0.0, 0.0, -10.0), (90.0, 0.0, -10.0)]
    log = run(Full(), positions=positions)
    assert (log["visible"][0], log["drawn"][0], log["triangles"][0]) == (1, 1, 1000)


def test_an_empty_view_costs_the_base(run: Run) -> None:
    """With nothing in view a frame still costs its base, and every sum is 0."""
    log = run(Full(), 3, positions=[(0.0, 0.0, 10.0)])
    assert log["gpu_ms"].tolist() == [1.0, 1.0, 1.0]
    for name in ("visible", "triangles", "benefit", "full_benefit", "sse_px_max", "toggles"):
        assert log[name].tolist() == [0.0, 0.0, 0.0]


def test_the_roofline_takes_the_larger_side_of_each_object(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware
) -> None:
    """Geometry of 0.1 ms loses to 0.2 ms of pixels near, and wins far away."""
    near, far = (0.0, 0.0, -10.0), (0.0, 0.0, -1000.0)
    pixel_ms = 0.2 / AREA_PX
    hardware = make_hardware(
        {}, base_ms=1.0, roofline={"triangles": 1e-4, "shaded_samples": pixel_ms}
    )
    both = run(Full(), positions=[near, far], hardware=hardware)
    assert both["model_gpu_ms"][0] == pytest.approx(1.0 + 0.2 + 0.1)
    coarse = run(scripted([[2, 2]]), positions=[near, far], hardware=hardware)
    far_px = math.pi * 2500.0 / (1000.0**2 - 1.0)
    assert coarse["model_gpu_ms"][0] == pytest.approx(1.0 + 0.2 + max(0.005, far_px * pixel_ms))


def test_frame_wide_terms(run: Run, make_hardware: MakeHardware) -> None:
    """Pixels of the frame buffer, samples and state changes enter as the model says."""
    hardware = make_hardware(
        {"framebuffer_pixels": 1e-4, "shaded_samples": 1e-3, "state_changes": 0.25}, base_ms=0.0
    )
    log = run(Full(), hardware=hardware)
    assert log["model_gpu_ms"][0] == pytest.approx(1e-4 * VIEWPORT_PX + 1e-3 * AREA_PX + 0.25)


def test_cpu_time_charges_the_policy_and_the_frame(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware
) -> None:
    """Visits, comparisons and iterations are the policy's; draws and culling the frame's."""
    cpu = {
        "objects_visited": 0.01, "comparisons": 0.002, "iterations": 0.3, "draw_calls": 0.05,
        "objects_culled": 0.001,
    }  # fmt: skip
    positions = [(0.0, 0.0, -10.0), (0.0, 0.0, 10.0)]
    work = Work(objects_visited=7, comparisons=11, iterations=2)
    log = run(scripted([1], work=work), positions=positions, hardware=make_hardware(cpu=cpu))
    assert log["select_ms"][0] == pytest.approx(0.07 + 0.022 + 0.6)
    assert log["cpu_ms"][0] == pytest.approx(0.5 + 0.692 + 0.05 + 0.002)
    assert log["objects_visited"][0] == 7
    assert log["comparisons"][0] == 11
    assert log["iterations"][0] == 2


def test_continuous_resolutions_by_hand(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels
) -> None:
    """Half the triangles lie between the knots 1 and 0.25: costs and error are interpolated."""
    levels = make_levels([(1000, 250, 50)], continuous=True)
    log = run(scripted([0.5]), levels=levels)
    assert log["triangles"][0] == pytest.approx(500)
    assert log["model_gpu_ms"][0] == pytest.approx(1.5)
    assert log["sse_px_max"][0] == pytest.approx(0.1 * (0.5 / 0.75) * UNIT_PX)
    assert log["benefit"][0] == pytest.approx(AREA_PX * (1 - 0.5 / 500))
    assert log["degradation"][0] == pytest.approx(AREA_PX / 500)


def test_the_95th_percentile_of_errors_is_of_the_lower_rank(
    run: Run, scripted: MakePolicy, make_levels: MakeLevels
) -> None:
    """Of 21 objects that err by 0 to 2 m in steps of 0.1 m, 19 err by less than 1.9 m."""
    levels = make_levels([range(21, 0, -1)])
    log = run(scripted([list(range(21))]), positions=[(0.0, 0.0, -10.0)] * 21, levels=levels)
    assert log["sse_px_p95"][0] == pytest.approx(1.9 * UNIT_PX)
    assert log["sse_px_max"][0] == pytest.approx(2.0 * UNIT_PX)


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_the_visible_load_is_of_full_detail_at_full_size(
    run: Run, scripted: MakePolicy, make_hardware: MakeHardware, scale: float
) -> None:
    """Neither a coarse level, nor a cross-fade that draws twice, nor a smaller picture changes it.

    The base of 1 ms, 1,000 triangles of 1 us, and 1 us a pixel of the ellipse at full size.
    """
    hardware = make_hardware({"triangles": 1e-3, "shaded_samples": 1e-3})
    options = {"crossfade_ms": 5.0}
    log = run(scripted([0, 2], render_scale=scale), 6, hardware=hardware, options=options)
    assert log["fading"][1] == 1
    assert log["fading"][5] == 0
    assert log["full_gpu_ms"] == pytest.approx(2.0 + 1e-3 * AREA_PX, rel=1e-12)
