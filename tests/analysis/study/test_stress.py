"""The search for bad paths: every point of the cube keeps the limits, and the search finds bad."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from lodbench.analysis.study.badness import check_badness, open_gauge
from lodbench.analysis.study.inputs import load_trace
from lodbench.analysis.study.stress import PathLimits, path_of, stress
from lodbench.base.errors import InputError, PolicyError
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene import Scene
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.orientation import turn_deg

LIMITS = PathLimits(duration_s=1.5, legs=4)
OPTIONS = ReplayOptions(budget_ms=8.0)
UNIT = st.floats(0.0, 1.0)

ENDS = """
import os
from lodbench.policies.bounds.full import Full

class Ends(Full):
    def select(self, view):
        return super().select(view) if view.frame < 5 else os._exit(0)
"""


@settings(max_examples=50, deadline=None, database=None)
@given(point=st.lists(UNIT, min_size=11, max_size=11))
def test_every_path_keeps_its_limits(small_scene: Scene, point: list[float]) -> None:
    """Speeds and turn rates between samples stay within the bounds; the height never changes."""
    trace = path_of(np.array(point), small_scene, LIMITS)
    steps_s = np.diff(trace.time_s)
    speed = np.linalg.norm(np.diff(trace.position_m, axis=0), axis=1) / steps_s
    turn = turn_deg(trace.orientation_xyzw[:-1], trace.orientation_xyzw[1:]) / steps_s
    assert speed.max() <= LIMITS.speed_m_s * (1.0 + 1e-9)
    assert turn.max() <= LIMITS.turn_deg_s * (1.0 + 1e-6)
    assert np.ptp(trace.position_m[:, 2]) == 0.0
    assert trace.duration_s == LIMITS.duration_s


def test_corners_of_the_cube_are_known_paths(small_scene: Scene) -> None:
    """All ones but no turn go straight ahead at full speed from the far corner."""
    point = np.array([1.0, 1.0, 0.0, *(1.0,) * 4, *(0.5,) * 4])
    trace = path_of(point, small_scene, LIMITS)
    length_m = LIMITS.speed_m_s * LIMITS.duration_s
    assert trace.position_m[-1] - trace.position_m[0] == pytest.approx([length_m, 0.0, 0.0])
    high = small_scene.center_m.max(axis=0) + small_scene.radius_m.max()
    assert trace.position_m[0, :2] == pytest.approx(high[:2])


@pytest.mark.parametrize("badness", ["overshoot", "toggles", "lag"])
def test_search_finds_worse_than_a_path_at_rest(
    badness: str, small_scene: Scene, machine: HardwareProfile
) -> None:
    """Each kind is worse on the path found than on a path that stands and looks away."""
    spec, kind = parse_policy("feedback"), check_badness(badness)
    calls: list[tuple[int, int]] = []
    away = path_of(np.array([0.0, 0.5, 0.5, *(0.0,) * 4, *(0.5,) * 4]), small_scene, LIMITS)
    with open_gauge(spec, small_scene, machine, OPTIONS, kind) as gauge:
        found = stress(
            gauge,
            small_scene,
            LIMITS,
            evaluations=20,
            progress=lambda done, total: calls.append((done, total)),
        )
        assert found.value > 1.2 * gauge(away)
    with open_gauge(spec, small_scene, machine, OPTIONS, kind) as gauge:
        assert gauge(found.trace) == found.value
    assert [done for done, _ in calls] == list(range(1, found.evaluations + 1))
    assert found.evaluations <= 20


def test_the_same_search_finds_the_same_path(small_scene: Scene, machine: HardwareProfile) -> None:
    """Nothing but the seed decides which path is found."""
    spec = parse_policy("feedback")
    with open_gauge(spec, small_scene, machine, OPTIONS, "overshoot") as gauge:
        paths = [
            stress(gauge, small_scene, LIMITS, seed=seed, evaluations=8).trace.position_m
            for seed in (1, 1, 2)
        ]
    assert np.array_equal(paths[0], paths[1])
    assert not np.array_equal(paths[0], paths[2])


def test_what_cannot_be_searched(small_scene: Scene, machine: HardwareProfile) -> None:
    """Unknown badness, impossible limits and too few paths are told."""
    with pytest.raises(InputError, match="expected overshoot, toggles, lag, got speed"):
        check_badness("speed")
    with pytest.raises(InputError, match="duration_s: expected"):
        PathLimits(duration_s=0.1)
    with pytest.raises(InputError, match="at least 8"):
        stress(lambda _: 0.0, small_scene, LIMITS, evaluations=3)


def test_what_a_policy_does_is_told_of_it(
    small_scene: Scene, machine: HardwareProfile, tmp_path: Path
) -> None:
    """A policy that ends its process on a path fails by frame, and this process goes on."""
    path = tmp_path / "mine.py"
    path.write_text(ENDS, encoding="utf-8")
    spec = parse_policy(f"{path}:Ends")
    trace = path_of(np.full(11, 0.5), small_scene, LIMITS)
    with (
        open_gauge(spec, small_scene, machine, OPTIONS, "lag") as gauge,
        pytest.raises(PolicyError, match="frame 5: process ended with status 0"),
    ):
        gauge(trace)


@pytest.mark.slow
def test_feedback_overshoots_twice_as_far_as_on_the_walk() -> None:
    """With the defaults of `lodbench stress` the bundled scene has a path twice as bad."""
    scene, hardware = load_scene("plaza"), load_hardware("desktop-assumed")
    spec, options = parse_policy("feedback"), ReplayOptions(budget_ms=1e3 / 60.0)
    walk = load_trace("walk", scene)
    with open_gauge(spec, scene, hardware, options, "overshoot") as gauge:
        before = gauge(walk)
        found = stress(gauge, scene, PathLimits())
    assert found.value >= 2.0 * before
    assert found.value > 1.0
