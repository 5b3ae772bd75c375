"""Ways through given points."""

import numpy as np
import pytest

from lodbench import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.route import follow_route
from lodbench.traces.cameras.orientation import turn_deg, view_direction

CORNER = np.array([[0.0, 0.0], [30.0, 0.0], [30.0, 20.0]])
SQUARE = np.array([[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0], [0.0, 0.0]])


def route(points: np.ndarray = CORNER, **other: float) -> CameraTrace:
    """Return a trace at 2 m/s for 20 s, 1.5 m up."""
    values = {"speed_m_s": 2.0, "height_m": 1.5, "duration_s": 20.0} | other
    return follow_route("way", points, **values)


def test_speed_and_height_are_constant() -> None:
    """2 m/s along the line, 1.5 m above it; 20 s end 10 m up the second leg."""
    trace = route()
    step = np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1) * 60.0
    assert step == pytest.approx(2.0, rel=2e-2)
    assert (trace.position_m[:, 2] == 1.5).all()
    assert trace.position_m[0] == pytest.approx([0.0, 0.0, 1.5])
    assert trace.position_m[-1] == pytest.approx([30.0, 10.0, 1.5], abs=0.5)


def test_corners_are_rounded_and_seen_early() -> None:
    """It keeps within the bend of the corner, and turns a quarter without a jerk."""
    trace = route(bend_m=2.0)
    away = np.minimum(np.abs(trace.position_m[:, 1]), np.abs(trace.position_m[:, 0] - 30.0))
    assert away.max() < 0.5
    first, last = view_direction(trace.orientation_xyzw)[[0, -1]]
    assert first == pytest.approx([1.0, 0.0, 0.0], abs=1e-6)
    assert last == pytest.approx([0.0, 1.0, 0.0], abs=1e-6)
    assert turn_deg(trace.orientation_xyzw[:-1], trace.orientation_xyzw[1:]).max() * 60.0 < 200.0


def test_ten_times_the_speed_is_the_same_way() -> None:
    """Sample k of the slow trace is where sample k / 10 of the fast one is."""
    slow = route(duration_s=20.0)
    fast = route(speed_m_s=20.0, duration_s=2.0)
    assert fast.position_m == pytest.approx(slow.position_m[::10], abs=1e-9)


def test_an_open_way_is_gone_there_and_back() -> None:
    """50 m at 5 m/s: at the far end after 10 s, back after 20 s, looking the other way."""
    trace = route(speed_m_s=5.0)
    assert trace.position_m[600] == pytest.approx([30.0, 20.0, 1.5], abs=0.6)
    assert trace.position_m[-1] == pytest.approx([0.0, 0.0, 1.5], abs=0.8)
    assert view_direction(trace.orientation_xyzw)[900] == pytest.approx([-1.0, 0.0, 0.0], abs=0.1)


def test_a_closed_way_is_gone_round() -> None:
    """160 m at 20 m/s: the same place every 8 s, less what the bends cut off."""
    trace = route(SQUARE, speed_m_s=20.0)
    lap = round(np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1)[:480].sum())
    assert lap == 160
    assert trace.position_m[475:485, :2].min() > -1.0
    assert np.linalg.norm(trace.position_m[480] - trace.position_m[0]) < 8.0


@pytest.mark.parametrize(
    ("points", "other"),
    [
        (CORNER[:1], {}),
        (CORNER[[0, 0]], {}),
        (CORNER, {"speed_m_s": 0.0}),
        (CORNER, {"duration_s": -1.0}),
        (CORNER, {"bend_m": np.nan}),
    ],
)
def test_no_way_is_refused(points: np.ndarray, other: dict[str, float]) -> None:
    """Too few points, no length, no speed, no time."""
    with pytest.raises(InputError, match="route: expected"):
        route(points, **other)


def test_a_start_is_a_share_of_the_round_or_of_there_and_back() -> None:
    """Half way round a square is its far corner; .75 of there and back is half way back."""
    far = route(SQUARE, start=0.5)
    assert far.position_m[0, :2] == pytest.approx([40.0, 40.0], abs=0.6)
    back = route(CORNER, start=0.75)
    assert back.position_m[0, :2] == pytest.approx([25.0, 0.0], abs=0.5)
    assert view_direction(back.orientation_xyzw)[0] == pytest.approx([-1.0, 0.0, 0.0], abs=1e-3)
