"""Variations of a path: as long as it, at another speed, from another start, with glances."""

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.orientation import look_along, turn_by, turn_deg, view_direction
from lodbench.traces.cameras.vary import GAZE_DEG, vary

SEEDS = range(40)


def straight(length_s: float = 20.0) -> CameraTrace:
    """Return a path at 1 m/s along +x that looks ahead, a sample every tenth of a second."""
    times = np.arange(round(length_s * 10) + 1) / 10.0
    position = np.column_stack((times, np.zeros_like(times), np.full_like(times, 1.65)))
    gaze = look_along(np.zeros_like(times), np.zeros_like(times))
    return CameraTrace("straight", times, position, gaze, np.zeros(len(times), bool))


def test_speeds_and_starts_are_within_their_bounds() -> None:
    """At 0.8 to 1.2 m/s from at most 2 m either way of the start, over the bounds' whole range."""
    speeds, starts = list[float](), list[float]()
    for seed in SEEDS:
        x = vary(straight(), seed).position_m[:, 0]
        speeds.append(float(np.median(np.abs(np.diff(x)))) * 30.0)
        starts.append(float(x[0]))
    assert 0.8 <= min(speeds) < 0.85
    assert 1.15 < max(speeds) <= 1.2
    assert min(starts) >= 0.0
    assert 1.5 < max(starts) <= 2.0


def test_as_long_as_the_path_and_never_off_it() -> None:
    """The clock ends where the path's does; places are on it; nothing jumps at its ends."""
    for seed in SEEDS:
        varied = vary(straight(), seed)
        x, y, z = varied.position_m.T
        assert varied.duration_s == 20.0
        assert x.min() >= 0.0
        assert x.max() <= 20.0
        assert (y == 0.0).all()
        assert z == pytest.approx(1.65)
        assert np.abs(np.diff(x)).max() <= 1.2 / 30.0 + 1e-9
        assert not varied.cut.any()


def test_glances_are_small_and_smooth() -> None:
    """The gaze leaves the path's by at most the bounds together, and at no more than 20 deg/s."""
    ahead = look_along(np.zeros(1), np.zeros(1))
    largest: list[float] = []
    for seed in SEEDS:
        gaze = vary(straight(), seed).orientation_xyzw
        off = turn_deg(np.broadcast_to(ahead, gaze.shape), gaze)
        largest.append(float(off.max()))
        assert turn_deg(gaze[:-1], gaze[1:]).max() * 30.0 < 20.0
        # No roll: the camera's right stays level.
        x, y, z, w = gaze.T
        assert 2.0 * (x * z - w * y) == pytest.approx(0.0, abs=1e-12)
    assert max(largest) <= np.hypot(GAZE_DEG, GAZE_DEG / 2.0)
    assert np.median(largest) > 0.5 * GAZE_DEG


def test_yaw_turns_left_and_pitch_looks_up() -> None:
    """From +x, 90 degrees of yaw look along +y; then 30 of pitch half a length up."""
    ahead = look_along(np.zeros(2), np.zeros(2))
    turned = turn_by(ahead, np.radians([90.0, 90.0]), np.radians([0.0, 30.0]))
    look = view_direction(turned)
    assert look[0] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert look[1] == pytest.approx([0.0, np.cos(np.radians(30.0)), 0.5], abs=1e-12)


def test_cuts_stay_cuts() -> None:
    """Where the path teleports 100 m, so do its variations, and nowhere do they move so else."""
    path = straight()
    position = path.position_m.copy()
    position[100:, 1] += 100.0
    cut = np.arange(len(position)) == 100
    for seed in SEEDS:
        varied = vary(CameraTrace("c", path.time_s, position, path.orientation_xyzw, cut), seed)
        step = np.linalg.norm(np.diff(varied.position_m, axis=0), axis=1)
        assert np.array_equal(step > 50.0, varied.cut[1:])
        assert varied.cut.any()


def test_same_seed_same_variation() -> None:
    """Not a bit differs; another seed does, and says so in its name."""
    first, again, other = (vary(straight(), seed) for seed in (5, 5, 6))
    assert np.array_equal(first.orientation_xyzw, again.orientation_xyzw)
    assert np.array_equal(first.position_m, again.position_m)
    assert not np.array_equal(first.position_m, other.position_m)
    assert first.name == again.name != other.name


def test_one_pose_and_wrong_seeds() -> None:
    """A path of one pose has nothing to vary; a seed below 0 is refused."""
    path = straight().stretch(0.0, 0.1)
    one = CameraTrace(
        "one", path.time_s[:1], path.position_m[:1], path.orientation_xyzw[:1], np.zeros(1, bool)
    )
    assert vary(one, 1) is one
    with pytest.raises(InputError, match="seed: expected"):
        vary(path, -1)
