"""The trial: every part is there, and load does in it what the part is named for."""

import numpy as np
import pytest

from lodbench.base.arrays import BoolArray, FloatArray
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate
from lodbench.traces.cameras.generators.load_map import LoadMap
from lodbench.traces.cameras.generators.motion_paths import Limits
from lodbench.traces.cameras.generators.trial import parts_of, trial
from lodbench.traces.cameras.orientation import turn_deg, view_direction

LIMITS = Limits(7.0, 12.0, 360.0)
SEEDS = range(30)


def town() -> LoadMap:
    """Return 400 heavy objects in the east of a plan of 200 m, and a few light ones all over it."""
    rng = np.random.default_rng(7)
    heavy = rng.uniform((20.0, -60.0), (90.0, 60.0), (400, 2))
    light = rng.uniform(-100.0, 100.0, (40, 2))
    load = np.repeat((10.0, 1.0), (400, 40))
    return LoadMap.of(np.concatenate((heavy, light)), load, np.zeros(2), np.full(2, 200.0))


TOWN = town()


def make(seed: int, duration_s: float = 12.0, load: LoadMap = TOWN) -> CameraTrace:
    """Return a trial at eye height."""
    return trial("t", load, LIMITS, height_m=1.65, duration_s=duration_s, seed=seed)


def loads_along(trace: CameraTrace, load: LoadMap = TOWN, half_deg: float = 45.0) -> FloatArray:
    """Return the load within so many degrees of the gaze, sample by sample, (n,)."""
    look = view_direction(trace.orientation_xyzw)[:, :2]
    seen = np.empty(len(trace))
    for i, eye in enumerate(trace.position_m[:, :2]):
        away = load.place_m - eye
        length = np.linalg.norm(away, axis=1)
        cosine = away @ look[i] / np.maximum(length * np.linalg.norm(look[i]), 1e-12)
        seen[i] = load.load[cosine > np.cos(np.radians(half_deg))].sum()
    return seen


def within(trace: CameraTrace, begin_s: float, end_s: float) -> BoolArray:
    """Return which samples are in a part, (n,)."""
    return (trace.time_s > begin_s - 1e-9) & (trace.time_s < end_s - 1e-9)


@pytest.mark.parametrize("duration_s", [12.0, 6.0, 30.0])
def test_every_part_is_there_for_its_share(duration_s: float) -> None:
    """In twelfths of the path: rest 2, ramp 3, steps 1 each, edge 2, turn 1, dash 2."""
    for seed in SEEDS:
        parts = parts_of(seed, duration_s)
        twelfths = {part: (end - begin) * 12.0 / duration_s for part, begin, end in parts}
        wanted = {"rest": 2, "ramp": 3, "up": 1, "down": 1, "edge": 2, "turn": 1, "dash": 2}
        assert twelfths == pytest.approx(wanted)
        assert parts[-1][2] == pytest.approx(duration_s)


def test_load_does_what_the_part_says() -> None:
    """Steps up at least triple it within a frame; ramps, turns and steps down are as large."""
    for seed in SEEDS:
        trace = make(seed)
        load = loads_along(trace)
        much = load.max()
        for part, begin, end in parts_of(seed):
            rows = np.flatnonzero(within(trace, begin, end))
            first, last = load[rows[0]], load[rows[-1]]
            before = load[rows[0] - 1] if rows[0] else None
            if part in ("up", "down") and before is not None:
                step = (before, first) if part == "up" else (first, before)
                assert step[1] > 3.0 * step[0], (seed, part)
            if part in ("ramp", "turn"):
                assert max(first, last) > 3.0 * min(first, last), (seed, part)
            if part == "ramp":  # slow: no frame changes a quarter of the most
                assert np.abs(np.diff(load[rows])).max() < 0.25 * much
            if part == "edge":  # over the edge and back, twice or three times
                assert np.ptp(load[rows]) > 0.15 * much, seed
                assert load[rows[-1]] == pytest.approx(first, abs=0.05 * much)


def test_parts_move_as_they_are_named() -> None:
    """Rest and steps stand still; a turn is over within its second; a dash runs, looking ahead."""
    for seed in SEEDS:
        trace = make(seed)
        for part, begin, end in parts_of(seed):
            rows = np.flatnonzero(within(trace, begin, end))
            turned = turn_deg(trace.orientation_xyzw[rows[:1]], trace.orientation_xyzw[rows])
            gone = np.linalg.norm(trace.position_m[rows] - trace.position_m[rows[0]], axis=1)
            if part in ("rest", "up", "down"):
                assert (turned.max(), gone.max()) == (0.0, 0.0)
            if part in ("ramp", "turn"):
                assert turned[-1] > 55.0
                assert gone.max() == 0.0
            if part == "edge":
                assert 4.0 < turned.max() < 91.0
                assert turned[-1] < 4.0
            if part == "dash":
                assert turned.max() == pytest.approx(0.0, abs=1e-6)
                assert 1.5 < gone[-1] < 9.0


def test_turns_are_sudden_and_ramps_are_slow() -> None:
    """The middle half of a turn's way takes less than 0.3 s, that of a ramp's more than 0.5 s."""
    for seed in SEEDS:
        trace = make(seed)
        for part, begin, end in parts_of(seed):
            if part in ("turn", "ramp"):
                rows = np.flatnonzero(within(trace, begin, end))
                turned = turn_deg(trace.orientation_xyzw[rows[:1]], trace.orientation_xyzw[rows])
                share = turned / turned.max()
                middle_s = np.ptp(trace.time_s[rows][(share > 0.25) & (share < 0.75)])
                assert middle_s < 0.3 if part == "turn" else middle_s > 0.5


def test_only_steps_are_cuts() -> None:
    """Each step that does not begin the path is a cut; elsewhere camera and gaze never jump."""
    for seed in SEEDS:
        trace = make(seed)
        steps = [begin for part, begin, _ in parts_of(seed) if part in ("up", "down") and begin]
        assert trace.time_s[trace.cut].tolist() == pytest.approx(steps, abs=1.0 / 60.0)
        moved = np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1)[~trace.cut[1:]]
        turned = turn_deg(trace.orientation_xyzw[:-1], trace.orientation_xyzw[1:])[~trace.cut[1:]]
        assert moved.max() * 60.0 <= LIMITS.speed_m_s * (1.0 + 1e-9)
        assert turned.max() * 60.0 <= LIMITS.turn_deg_s * (1.0 + 1e-9)


def test_something_is_always_in_view() -> None:
    """On no sample of any path, not even within 30 degrees of the gaze, is there nothing."""
    for seed in SEEDS:
        assert loads_along(make(seed), half_deg=30.0).min() > 0.0, seed


def test_seeds_differ_in_order_place_and_speed() -> None:
    """Thirty seeds have many orders, start all over the plan, and dash at many speeds."""
    orders = {tuple(part for part, _, _ in parts_of(seed)) for seed in SEEDS}
    starts = {tuple(make(seed).position_m[0].tolist()) for seed in SEEDS}
    assert len(orders) > 20
    assert len(starts) > 20
    speeds: list[float] = []
    for seed in SEEDS:
        trace = make(seed)
        step = np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1)
        speeds.append(float(step[~trace.cut[1:]].max()) * 60.0)
    assert np.ptp(speeds) > 1.0


def test_same_seed_is_the_same_path() -> None:
    """Twice made, not a bit differs; another seed or another load does."""
    first, again = make(3), make(3)
    assert np.array_equal(first.position_m, again.position_m)
    assert np.array_equal(first.orientation_xyzw, again.orientation_xyzw)
    assert not np.array_equal(first.position_m, make(4).position_m)


def test_eyes_stay_on_the_way() -> None:
    """With a way, no sample is off it by more than the sway to and fro."""
    way = np.array([[-80.0, 0.0], [15.0, 0.0], [15.0, 80.0]])
    load = LoadMap(TOWN.place_m, TOWN.load, TOWN.low_m, TOWN.high_m, way)
    for seed in SEEDS:
        x, y = make(seed, load=load).position_m[:, :2].T
        first = np.hypot(y, np.maximum(np.maximum(-80.0 - x, x - 15.0), 0.0))
        second = np.hypot(x - 15.0, np.maximum(np.maximum(-y, y - 80.0), 0.0))
        assert np.minimum(first, second).max() < 1e-6


@pytest.mark.parametrize(
    "place", [[[0.0, 0.0]], [[60.0, 60.0], [60.0, 60.0]], [[-1.0, 0.0], [1.0, 0.0]]]
)
def test_hardly_a_scene_still_has_a_path(place: list[list[float]]) -> None:
    """With one thing or two, parts that cannot change the load still keep it in view."""
    load = LoadMap.of(np.array(place), np.ones(len(place)), np.zeros(2), np.full(2, 100.0))
    for seed in SEEDS:
        trace = make(seed, load=load)
        assert trace.duration_s == 12.0
        assert loads_along(trace, load, half_deg=30.0).min() > 0.0


def test_without_a_scene_half_of_the_square_is_loaded() -> None:
    """`generate` knows no scene: its trial is one of a square with load in its east."""
    trace = generate("trial", extent_m=80.0, seed=2)
    x, y = np.meshgrid(np.linspace(1.6, 38.4, 12), np.linspace(-38.4, 38.4, 24))
    place = np.stack((x.ravel(), y.ravel()), axis=1)
    load = LoadMap(place, np.ones(len(place)), np.full(2, -40.0), np.full(2, 40.0))
    seen = loads_along(trace, load, half_deg=30.0)
    assert trace.duration_s == 12.0
    assert seen.min() > 0.0
    assert seen.max() > 3.0 * seen.min()
