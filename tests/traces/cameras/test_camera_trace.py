"""The pose of a camera trace at any time."""

import pickle
import timeit

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace, FloatArray

ROOT_HALF = np.sqrt(0.5)


def make_trace(
    times: list[float], positions: list[list[float]], quaternions: list[list[float]], **cut: int
) -> CameraTrace:
    """Trace from lists, with at most one cut, at the sample named ``at``."""
    flags = np.zeros(len(times), dtype=bool)
    if "at" in cut:
        flags[cut["at"]] = True
    return CameraTrace("t", np.array(times), np.array(positions), np.array(quaternions), cut=flags)


def random_trace(seed: int, count: int) -> CameraTrace:
    """Trace of random poses with a cut about every tenth sample."""
    rng = np.random.default_rng(seed)
    cut = rng.random(count) < 0.1
    cut[0] = False
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(1e-3, 0.5, count - 1))])
    quaternions: FloatArray = Rotation.random(count, rng=rng).as_quat()
    return CameraTrace("random", times, rng.normal(size=(count, 3)), quaternions, cut)


def test_midpoint_of_a_quarter_turn() -> None:
    """Half-way through a 90 degree turn about z and a move of 2 m, it is 45 degrees and 1 m."""
    trace = make_trace(
        [0.0, 4.0],
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]],
        [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, ROOT_HALF, ROOT_HALF]],
    )
    pose = trace.pose_at(2.0)
    assert pose.position_m == (1.0, 0.0, 0.0)
    expected = (0.0, 0.0, np.sin(np.pi / 8), np.cos(np.pi / 8))
    assert pose.orientation_xyzw == pytest.approx(expected, abs=1e-15)


def test_negated_quaternion_takes_the_shorter_arc() -> None:
    """A quaternion and its negative are one orientation, so nothing turns between them."""
    trace = make_trace(
        [0.0, 1.0],
        [[0.0] * 3] * 2,
        [[0.0, 0.0, ROOT_HALF, ROOT_HALF], [0.0, 0.0, -ROOT_HALF, -ROOT_HALF]],
    )
    half = trace.pose_at(0.5).orientation_xyzw
    assert half == pytest.approx((0.0, 0.0, ROOT_HALF, ROOT_HALF), abs=1e-15)


def test_a_camera_at_rest_has_the_same_bits() -> None:
    """Between two equal poses, at any time, the pose is exactly theirs; so is each half of it."""
    rng = np.random.default_rng(6)
    for turn in Rotation.random(40, rng=rng).as_quat().tolist():
        here, there = rng.normal(size=(2, 3)).tolist()
        other = Rotation.random(rng=rng).as_quat().tolist()
        still = make_trace([0.0, 0.7], [here] * 2, [turn, turn])
        moving = make_trace([0.0, 0.7], [here, there], [turn, [-value for value in turn]])
        turning = make_trace([0.0, 0.7], [here] * 2, [turn, other])
        for time_s in rng.uniform(0.0, 0.7, 20).tolist():
            assert still.pose_at(time_s) == (tuple(here), tuple(turn))
            assert moving.pose_at(time_s).orientation_xyzw == tuple(turn)
            assert turning.pose_at(time_s).position_m == tuple(here)


def test_cut_holds_the_pose_before_it() -> None:
    """Nothing is interpolated across a teleport; the new pose starts exactly at its time."""
    trace = make_trace(
        [0.0, 1.0, 2.0], [[0.0] * 3, [9.0] * 3, [11.0] * 3], [[0.0, 0.0, 0.0, 1.0]] * 3, at=1
    )
    assert trace.pose_at(0.999).position_m == (0.0, 0.0, 0.0)
    assert trace.pose_at(1.0).position_m == (9.0, 9.0, 9.0)
    assert trace.pose_at(1.5).position_m == (10.0, 10.0, 10.0)


def test_poses_are_held_outside_the_samples() -> None:
    """Before the first and after the last sample the pose is the nearest sample's."""
    trace = random_trace(3, 5)
    assert trace.pose_at(-7.0).position_m == tuple(trace.position_m[0])
    assert trace.pose_at(1e9).orientation_xyzw == tuple(trace.orientation_xyzw[-1])


def test_single_sample_is_a_still_camera() -> None:
    """A trace of one sample has no duration and one pose."""
    trace = make_trace([0.0], [[1.0, 2.0, 3.0]], [[0.0, 0.0, 0.0, 1.0]])
    assert trace.duration_s == 0.0
    assert trace.pose_at(5.0).position_m == (1.0, 2.0, 3.0)


@pytest.mark.parametrize("turn_deg", [1e-9, 1e-4, 1e-3, 2e-3, 1.0, 90.0, 179.999])
def test_slerp_agrees_with_scipy(turn_deg: float) -> None:
    """The interpolated orientation is scipy's slerp, from tiny to half turns."""
    ends = Rotation.from_euler("z", [[10.0], [10.0 + turn_deg]], degrees=True)
    trace = make_trace([0.0, 1.0], [[0.0] * 3] * 2, ends.as_quat().tolist())
    slerp = Slerp([0.0, 1.0], ends)
    for time in np.linspace(0.0, 1.0, 11):
        ours = Rotation.from_quat(trace.pose_at(float(time)).orientation_xyzw)
        assert (ours.inv() * slerp(time)).magnitude() < 1e-9


def test_arrays_are_read_only_copies() -> None:
    """The caller's arrays can change without the trace changing, and the trace cannot."""
    times = np.array([0.0, 1.0])
    trace = CameraTrace(
        "t", times, np.zeros((2, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (2, 1)), np.zeros(2, bool)
    )
    times[1] = 5.0
    assert trace.time_s[1] == 1.0
    with pytest.raises(ValueError, match="read-only"):
        trace.position_m[0, 0] = 1.0


def test_pickle_keeps_the_poses() -> None:
    """A trace sent to another process gives the same poses and is read-only there too."""
    trace = random_trace(1, 20)
    copy: CameraTrace = pickle.loads(pickle.dumps(trace))
    assert copy.pose_at(1.234) == trace.pose_at(1.234)
    assert (copy.name, copy.origin_s, copy.repairs) == (trace.name, trace.origin_s, trace.repairs)
    assert not copy.position_m.flags.writeable


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time_s": [0.0, 1.0, 1.0]}, "increase strictly"),
        ({"time_s": [0.5, 1.0, 2.0]}, "increase strictly from 0"),
        ({"time_s": [0.0, 1.0, np.nan]}, "time_s: expected finite"),
        ({"time_s": []}, "at least one sample"),
        ({"position_m": np.zeros((2, 3))}, "position_m: expected shape"),
        ({"position_m": np.full((3, 3), np.inf)}, "position_m: expected finite"),
        ({"orientation_xyzw": np.ones((3, 4))}, "unit quaternions"),
        ({"cut": [True, False, False]}, "cut"),
    ],
)
def test_broken_arrays_are_refused(change: dict[str, FloatArray], message: str) -> None:
    """Each rule of the constructor names what it wanted and what it got."""
    good: dict[str, FloatArray] = {
        "time_s": np.arange(3.0),
        "position_m": np.zeros((3, 3)),
        "orientation_xyzw": np.tile([0.0, 0.0, 0.0, 1.0], (3, 1)),
        "cut": np.zeros(3),
    }
    fields = {**good, **change}
    with pytest.raises(InputError, match=message):
        CameraTrace(
            "t",
            fields["time_s"],
            fields["position_m"],
            fields["orientation_xyzw"],
            np.asarray(fields["cut"], dtype=bool),
        )


def test_a_pose_is_cheap() -> None:
    """One lookup in a long trace costs a few microseconds (the bound allows a slow machine)."""
    trace = random_trace(5, 20_000)
    middle = trace.duration_s / 2.0
    best_s = min(timeit.repeat(lambda: trace.pose_at(middle), number=1000, repeat=5)) / 1000
    assert best_s < 20e-6


def standing(times: list[float]) -> CameraTrace:
    """Trace of a camera that stands still, at these times."""
    return make_trace(times, [[0.0] * 3] * len(times), [[0.0, 0.0, 0.0, 1.0]] * len(times))


def test_poses_an_hour_apart_are_the_farthest() -> None:
    """A pose after more than an hour is named by its number, and so is one after two days."""
    assert standing([0.0, 3600.0, 7200.0]).duration_s == 7200.0
    ten_years_s = 10 * 365.25 * 86400.0
    with pytest.raises(InputError) as caught:
        standing([0.0, 1.0, 1.0 + ten_years_s])
    assert str(caught.value) == (
        "expected poses at most an hour apart, got 3.15576e+08 s (3.65e+03 days) without one "
        "(pose 2 of 3); split the trace there"
    )
    hours = [3600.0 * hour for hour in range(49)]
    assert standing(hours).duration_s == 48 * 3600.0
    with pytest.raises(InputError, match=r"48 hours, got 172801 s .* \(pose 49 of 50\)"):
        standing([*hours, 48 * 3600.0 + 1.0])


@pytest.mark.parametrize("time_s", [1e308, np.inf, np.nan, -1.0, 0.0])
def test_arrays_of_times_that_are_none(time_s: float) -> None:
    """What no clock shows is refused before anything is replayed."""
    with pytest.raises(InputError, match=r"time_s|an hour apart"):
        standing([0.0, time_s])


@pytest.mark.parametrize("seed", range(5))
def test_a_stretch_is_the_same_path_on_a_clock_of_its_own(seed: int) -> None:
    """At every time the camera is where the whole path has it, teleports included."""
    trace = random_trace(seed, 60)
    start_s, end_s = 0.23 * trace.duration_s, 0.81 * trace.duration_s
    part = trace.stretch(start_s, end_s)
    assert part.duration_s == pytest.approx(end_s - start_s)
    assert part.name == f"random {start_s:g}:{end_s:g} s"
    assert part.origin_s == start_s
    for at_s in np.linspace(0.0, part.duration_s, 400)[1:-1]:
        whole, cut = trace.pose_at(start_s + at_s), part.pose_at(at_s)
        assert cut.position_m == pytest.approx(whole.position_m, abs=1e-9)
        assert cut.orientation_xyzw == pytest.approx(whole.orientation_xyzw, abs=1e-9)


def test_a_stretch_by_hand() -> None:
    """From 1 to 5 s of a way of a metre a second: two poses in between, and both ends."""
    way = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 0.0, 0.0], [9.0, 0.0, 0.0]]
    trace = make_trace([0.0, 2.0, 4.0, 6.0], way, [[0.0, 0.0, 0.0, 1.0]] * 4, at=3)
    part = trace.stretch(1.0, 5.0)
    assert part.time_s.tolist() == [0.0, 1.0, 3.0, 4.0]
    # The last pose is held until the teleport at 6 s.
    assert part.position_m[:, 0].tolist() == [1.0, 2.0, 4.0, 4.0]
    assert not part.cut.any()
    assert trace.stretch(1.0).cut.tolist() == [False, False, False, True]
    assert trace.stretch() is trace
    assert trace.stretch(0.0, 6.0) is trace


@pytest.mark.parametrize(
    ("start_s", "end_s"),
    [(2.0, 2.0), (3.0, 1.0), (-1.0, 2.0), (0.0, 6.1), (6.0, None), (np.nan, 2.0)],
)
def test_an_empty_stretch_is_refused(start_s: float, end_s: float | None) -> None:
    """What is empty, or not all on the path, is told with the path's length."""
    trace = make_trace([0.0, 6.0], [[0.0] * 3] * 2, [[0.0, 0.0, 0.0, 1.0]] * 2)
    with pytest.raises(InputError, match=r"seconds: expected a stretch of t within 0:6, got"):
        trace.stretch(start_s, end_s)
