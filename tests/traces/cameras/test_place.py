"""Placing a trace into a scene."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate
from lodbench.traces.cameras.orientation import view_direction
from lodbench.traces.cameras.place import Placement, fit_placement, place
from lodbench.traces.cameras.trace_stats import trace_stats


def looking_ahead() -> CameraTrace:
    """Level camera at (1, 2, 3) that looks along +x."""
    orientation = Rotation.from_euler("ZX", [-90.0, 90.0], degrees=True).as_quat()
    return CameraTrace(
        "t",
        np.zeros(1),
        np.array([[1.0, 2.0, 3.0]]),
        orientation[np.newaxis],
        np.zeros(1, bool),
    )


def test_order_is_up_yaw_scale_offset() -> None:
    """(1, 2, 3) with y up is (1, -3, 2); turned by 90 degrees (3, 1, 2); times 2; plus 100 in x."""
    placement = Placement(scale=2.0, offset_m=(100.0, 0.0, 0.0), up="y", yaw_deg=90.0)
    placed = place(looking_ahead(), placement)
    assert np.allclose(placed.position_m, [[106.0, 2.0, 4.0]])
    assert np.allclose(view_direction(placed.orientation_xyzw), [[0, 1, 0]], atol=1e-12)


@pytest.mark.parametrize(
    ("up", "axis"),
    [
        ("x", (1, 0, 0)),
        ("y", (0, 1, 0)),
        ("z", (0, 0, 1)),
        ("-x", (-1, 0, 0)),
        ("-y", (0, -1, 0)),
        ("-z", (0, 0, -1)),
    ],
)
def test_up_axis_becomes_z(up: str, axis: tuple[int, int, int]) -> None:
    """A point one metre up in the source is one metre up in the scene."""
    at_one = CameraTrace(
        "t", np.zeros(1), np.array([axis]), np.array([[0.0, 0.0, 0.0, 1.0]]), np.zeros(1, bool)
    )
    assert np.allclose(place(at_one, Placement(up=up)).position_m, [[0, 0, 1]], atol=1e-15)


@settings(max_examples=25)
@given(
    scale=st.floats(0.01, 100.0),
    yaw_deg=st.floats(-360.0, 360.0),
    up=st.sampled_from(["x", "y", "-z"]),
)
def test_scale_changes_speed_and_nothing_else_of_the_motion(
    scale: float, yaw_deg: float, up: str
) -> None:
    """Times, cuts and turn rates stay; speeds and path length are multiplied."""
    trace = generate("walk", duration_s=2.0)
    placed = place(trace, Placement(scale=scale, yaw_deg=yaw_deg, up=up, offset_m=(5.0, 6.0, 7.0)))
    before, after = trace_stats(trace), trace_stats(placed)
    assert np.array_equal(placed.time_s, trace.time_s)
    assert after.path_m == pytest.approx(scale * before.path_m)
    assert after.speed_m_s.p95 == pytest.approx(scale * before.speed_m_s.p95)
    assert after.turn_deg_s.p95 == pytest.approx(before.turn_deg_s.p95)


def test_the_default_placement_changes_no_bit() -> None:
    """Converting without placement options keeps the samples exactly."""
    trace = generate("walk", duration_s=2.0)
    placed = place(trace, Placement())
    assert np.array_equal(placed.position_m, trace.position_m)
    assert np.array_equal(placed.orientation_xyzw, trace.orientation_xyzw)


def test_fit_fills_the_tighter_side_and_stands_on_the_ground() -> None:
    """A path of 10 m by 4 m in 20 m by 20 m is doubled; its lowest sample is at eye height."""
    quaternions = np.tile([0.0, 0.0, 0.0, 1.0], (3, 1))
    positions = np.array([[0.0, 0.0, 1.0], [10.0, 4.0, 3.0], [5.0, 2.0, 2.0]])
    trace = CameraTrace("t", np.arange(3.0), positions, quaternions, np.zeros(3, bool))
    fitted = fit_placement(
        trace, center_m=(100.0, 200.0, 50.0), extent_m=(20.0, 20.0), eye_height_m=1.6
    )
    placed = place(trace, fitted)
    expected = [[90.0, 196.0, 51.6], [110.0, 204.0, 55.6], [100.0, 200.0, 53.6]]
    assert np.allclose(placed.position_m, expected)


def test_a_still_path_keeps_its_scale() -> None:
    """A camera that only looks around is moved to the middle, not blown up."""
    trace = generate("look-around", duration_s=2.0, center_m=(7.0, 8.0, 0.0))
    fitted = fit_placement(
        trace, center_m=(0.0, 0.0, 0.0), extent_m=(50.0, 50.0), eye_height_m=1.65
    )
    assert fitted.scale == 1.0
    assert np.allclose(place(trace, fitted).position_m, [0.0, 0.0, 1.65])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"scale": 0.0}, "expected a scale above 0, got 0.0"),
        ({"scale": float("nan")}, "expected a scale above 0, got nan"),
        ({"offset_m": (0.0, float("inf"), 0.0)}, "expected a finite offset"),
        ({"up": "north"}, "expected an up axis out of z, y, x, -z, -y, -x, got 'north'"),
    ],
)
def test_wrong_placements_are_refused(arguments: dict[str, float], message: str) -> None:
    """Each field of a placement is checked when it is made."""
    with pytest.raises(InputError, match=message):
        Placement(**arguments)  # pyright: ignore[reportArgumentType]


def test_a_scene_without_extent_is_refused() -> None:
    """There is no scale that fits a path into nothing."""
    with pytest.raises(InputError, match="expected an extent above 0"):
        fit_placement(
            looking_ahead(), center_m=(0.0, 0.0, 0.0), extent_m=(0.0, 5.0), eye_height_m=1.6
        )
