"""Generated traces: duration, bounds, smoothness, determinism, and what each kind is for."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.traces.cameras.camera_trace import CameraTrace, FloatArray
from lodbench.traces.cameras.formats.native_csv import write_csv
from lodbench.traces.cameras.generators.generate import BOB_M, KINDS, STEPS_HZ, generate
from lodbench.traces.cameras.orientation import turn_deg, view_direction
from lodbench.traces.cameras.trace_stats import trace_stats


def horizontal_speed(trace: CameraTrace) -> FloatArray:
    """Speed (n - 1,) between samples, without cuts."""
    step_m = np.linalg.norm(np.diff(trace.position_m[:, :2], axis=0), axis=1)
    return (step_m / np.diff(trace.time_s))[~trace.cut[1:]]


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25)
@given(
    seed=st.integers(0, 2**64),
    duration_s=st.floats(0.001, 30.0),
    rate_hz=st.floats(1.0, 120.0),
    extent_m=st.floats(1.0, 1000.0),
)
def test_duration_bounds_and_extent_hold(
    kind: str, seed: int, duration_s: float, rate_hz: float, extent_m: float
) -> None:
    """The last sample is at the duration; speed, turn rate and extent keep to their bounds."""
    trace = generate(kind, seed=seed, duration_s=duration_s, rate_hz=rate_hz, extent_m=extent_m)
    limits = KINDS[kind].limits
    assert trace.duration_s == duration_s
    assert abs(len(trace) - 1 - duration_s * rate_hz) <= 1.0
    assert horizontal_speed(trace).max(initial=0.0) <= limits.speed_m_s * (1 + 1e-9) + 1e-9
    assert trace_stats(trace).turn_deg_s.max <= limits.turn_deg_s * (1 + 1e-6)
    assert np.abs(trace.position_m[:, :2]).max() <= 0.5 * extent_m * (1 + 1e-9)
    norm = np.linalg.norm(trace.orientation_xyzw, axis=1)
    assert np.allclose(norm, 1.0, rtol=0.0, atol=1e-12)
    if kind != "trial":
        assert trace.cut.any() == (kind == "teleport" and duration_s >= 3.0)


@pytest.mark.parametrize("kind", KINDS)
def test_same_seed_same_bytes_other_seed_other_path(
    kind: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """Files of one seed are equal byte for byte; those of another differ."""
    folder = tmp_path_factory.mktemp("seeds")
    written: list[bytes] = []
    for number, seed in enumerate((5, 5, 6)):
        write_csv(generate(kind, seed=seed, duration_s=5.0), folder / f"{number}.csv")
        written.append((folder / f"{number}.csv").read_bytes().partition(b"\n")[2])
    assert written[0] == written[1]
    assert written[0] != written[2]


@pytest.mark.parametrize("kind", ["walk", "drive", "fly-over", "dash", "sudden-turn"])
def test_speed_does_not_jump(kind: str) -> None:
    """Along the path the speed changes by no more than the kind's acceleration allows."""
    trace = generate(kind, rate_hz=100.0, seed=1)
    limits = KINDS[kind].limits
    change = np.abs(np.diff(horizontal_speed(trace))) * 100.0
    assert change.max() <= 2.0 * limits.acceleration_m_s2
    assert horizontal_speed(trace).max() > 0.9 * limits.speed_m_s


@pytest.mark.parametrize("kind", ["walk", "drive", "fly-over"])
def test_travellers_look_where_they_go(kind: str) -> None:
    """The horizontal view direction is the direction of travel, but for glances aside."""
    trace = generate(kind, rate_hz=30.0, seed=2)
    step = np.diff(trace.position_m[:, :2], axis=0)
    look = view_direction(trace.orientation_xyzw)[:-1, :2]
    cosine = np.sum(step * look, axis=1) / np.linalg.norm(step, axis=1)
    cosine /= np.linalg.norm(look, axis=1)
    assert np.mean(cosine) > (0.9 if kind == "walk" else 0.99)


def test_walker_bobs_twice_a_second() -> None:
    """The height swings by 2 cm about the eye height at the pace of the steps."""
    trace = generate("walk", duration_s=10.0, rate_hz=100.0)
    bob = trace.position_m[:-1, 2] - 1.65
    spectrum = np.abs(np.fft.rfft(bob))
    assert np.argmax(spectrum) / 10.0 == STEPS_HZ
    assert np.abs(bob).max() == pytest.approx(BOB_M, rel=0.01)


def test_orbit_keeps_its_distance_and_looks_at_the_centre() -> None:
    """Every sample is on the circle, and the centre lies on the view axis."""
    trace = generate("orbit", center_m=(10.0, 20.0, 5.0), extent_m=60.0, height_m=8.0)
    to_center = np.array([10.0, 20.0, 5.0]) - trace.position_m
    distance = np.linalg.norm(to_center, axis=1)
    assert np.allclose(distance, np.hypot(30.0, 8.0))
    assert np.allclose(view_direction(trace.orientation_xyzw), to_center / distance[:, np.newaxis])


def test_look_around_stands_and_turns() -> None:
    """The position never changes while the head turns through more than a full circle."""
    trace = generate("look-around", center_m=(1.0, 2.0, 3.0))
    assert np.array_equal(np.unique(trace.position_m, axis=0), [[1.0, 2.0, 3.0 + 1.65]])
    turned = turn_deg(trace.orientation_xyzw[:-1], trace.orientation_xyzw[1:])
    assert turned.sum() > 360.0


def test_dash_stands_four_seconds_and_runs() -> None:
    """Still for 4 s, then at 7 m/s after 7/6 s of acceleration."""
    trace = generate("dash", rate_hz=100.0, duration_s=10.0)
    speed = horizontal_speed(trace)
    assert speed[:399].max() < 1e-9
    assert speed[405] > 0.0
    assert speed[530] == pytest.approx(7.0)


def test_teleport_cuts_every_three_seconds() -> None:
    """At 3, 6 and 9 s the camera is somewhere else; between them it does not move."""
    trace = generate("teleport", duration_s=10.0, rate_hz=60.0)
    assert trace.time_s[trace.cut].tolist() == [3.0, 6.0, 9.0]
    assert len(np.unique(trace.position_m, axis=0)) == 4
    assert horizontal_speed(trace).max() == 0.0


def test_sudden_turn_shows_the_scene_at_once() -> None:
    """Within 0.7 s the centre of the scene goes from right behind the camera to right ahead."""
    trace = generate("sudden-turn", rate_hz=100.0, duration_s=30.0)
    to_center = -trace.position_m[:, :2]
    to_center /= np.linalg.norm(to_center, axis=1, keepdims=True)
    ahead = np.sum(to_center * view_direction(trace.orientation_xyzw)[:, :2], axis=1)
    behind_last = np.flatnonzero(ahead < -0.999)[-1]
    ahead_again = behind_last + np.flatnonzero(ahead[behind_last:] > 0.999)[0]
    assert trace.time_s[ahead_again] - trace.time_s[behind_last] < 0.7


def test_speed_and_height_can_be_given() -> None:
    """A speed replaces the kind's bound, a height its camera height."""
    trace = generate("drive", speed_m_s=5.0, height_m=2.5, center_m=(0.0, 0.0, 100.0))
    assert horizontal_speed(trace).max() == pytest.approx(5.0, rel=1e-3)
    assert np.allclose(trace.position_m[:, 2], 102.5)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"kind": "wlak"}, "kind: expected one of walk, .*, got wlak; did you mean walk?"),
        ({"duration_s": 0.0}, "expected a duration from 0.001 to 21600 s, got 0.0"),
        ({"duration_s": 1e6}, "expected a duration"),
        ({"rate_hz": float("nan")}, "expected a rate from 0.001 to 10000 Hz, got nan"),
        ({"speed_m_s": -1.0}, "expected a speed"),
        ({"kind": "look-around", "speed_m_s": 1.0}, "expected no speed for look-around"),
        ({"extent_m": float("inf")}, "expected an extent"),
        ({"height_m": float("nan")}, "expected a centre and height"),
        ({"seed": -1}, "expected a seed of at least 0, got -1"),
    ],
)
def test_wrong_arguments_are_refused(arguments: dict[str, float], message: str) -> None:
    """Each argument out of its range is named with the range."""
    with pytest.raises(InputError, match=message):
        generate(**{"kind": "walk", **arguments})  # pyright: ignore[reportArgumentType]
