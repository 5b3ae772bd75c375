"""Test the ladder of level biases."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.scene.scene import Scene
from lodbench.policies.controllers.unity_adaptive import UnityAdaptive, judge_trend
from lodbench.policies.frame_times import Completed
from lodbench.policies.view import View

Make = Callable[..., Any]
TARGET_MS = 1e3 / 60.0


@pytest.mark.parametrize(
    ("rate_hz", "action"),
    [
        (120, "stale"),
        (60, "stale"),
        (50, "decrease"),
        (45, "fast-decrease"),
        (30, "fast-decrease"),
        (15, "fast-decrease"),
    ],
)
def test_actions_at_a_target_of_sixty(rate_hz: float, action: str) -> None:
    """The oracle of Unity's own unit test (notes, section 2.1)."""
    assert judge_trend(np.full(120, 60.0 / rate_hz - 1.0)) == action


def test_trend_is_the_mean() -> None:
    """Half the frames at 40 % over and half on target is 20 % over; no frames ask for nothing."""
    assert judge_trend(np.array([0.4, 0.0] * 60)) == "decrease"
    assert judge_trend(np.empty(0)) == "stale"


@pytest.fixture(scope="module")
def rows(make_scene: Make, make_levels: Make) -> Scene:
    """Return objects ahead whose levels at ratio 0.5 tell the four biases apart."""
    depth_m = 4.0 * 2.0 ** np.linspace(0.0, 3.0, 33)
    position_m = np.column_stack((np.zeros(33), np.zeros(33), -depth_m))
    return make_scene(position_m, levels=make_levels([[32.0, 16.0, 8.0, 4.0, 2.0, 1.0]]))


def drive(
    scene: Scene,
    make_view: Make,
    time_of_scale: Callable[[float], float],
    frames: int,
    **params: Any,
) -> list[tuple[float, float]]:
    """Return (seconds, bias) of each change, at 60 Hz, the time of each frame told in the next.

    The bias is read off what is drawn, by comparison with the four that it can be.
    """
    policy = UnityAdaptive(**params)
    policy.reset(scene, TARGET_MS)
    base = make_view(scene)
    drawn: dict[bytes, float] = {}
    for scale in (1.0, 0.8, 0.6, 0.4):
        other = UnityAdaptive(min_scale=scale, max_level=1, retry_s=0.0)
        other.reset(scene, TARGET_MS)
        late = make_view(scene, work_ms=[100.0])
        drawn[other.select(late).detail.tobytes()] = scale
    assert len(drawn) == 4
    times_ms = np.zeros((frames, 4))
    changes: list[tuple[float, float]] = []
    for frame in range(frames):
        time_ns = round(frame * 1e9 / 60.0)
        state = replace(
            base.state, frame=frame, time_ns=time_ns, completed=Completed(times_ms, frame)
        )
        scale = drawn[policy.select(View(state, base.ids, base.xyz_m)).detail.tobytes()]
        if not changes or changes[-1][1] != scale:
            changes.append((time_ns / 1e9, scale))
        times_ms[frame] = time_of_scale(scale) * (1.0 + 1e-6 * (frame % 5))
    return changes


def test_ladder_goes_down_step_by_step(rows: Scene, make_view: Make) -> None:
    """Hopelessly slow: the first step after 10 s, then every 2 s, biases 1, 0.8, 0.6, 0.4."""
    changes = drive(rows, make_view, lambda _: 2.0 * TARGET_MS, 1200)
    assert [scale for _, scale in changes] == [1.0, 0.8, 0.6, 0.4]
    assert [second for second, _ in changes] == pytest.approx([0.0, 10.0, 12.0, 14.0], abs=0.05)


def test_slightly_slow_frames_step_every_four_seconds(rows: Scene, make_view: Make) -> None:
    """20 % over is no reason to hurry."""
    changes = drive(rows, make_view, lambda _: 1.2 * TARGET_MS, 1200)
    assert [second for second, _ in changes] == pytest.approx([0.0, 10.0, 14.0, 18.0], abs=0.05)


def test_a_load_between_two_steps_never_rests(rows: Scene, make_view: Make) -> None:
    """Too slow at 1 and fine at 0.8: down for 4 s, up for 10 s, and so on for ever."""
    changes = drive(
        rows, make_view, lambda scale: (1.2 if scale == 1.0 else 0.9) * TARGET_MS, 60 * 60
    )
    seconds = [second for second, _ in changes[1:]]
    assert [scale for _, scale in changes] == [1.0, 0.8] * 4 + [1.0]
    assert np.diff(seconds) == pytest.approx([4.0, 10.0] * 3 + [4.0], abs=0.05)


def test_faulty_times_never_raise_detail(rows: Scene, make_view: Make) -> None:
    """A ladder that went down stays down while reports are missing or zero."""
    for fault in (np.nan, 0.0):
        policy = UnityAdaptive(retry_s=0.0)
        policy.reset(rows, TARGET_MS)
        times_ms = [3.0 * TARGET_MS]
        finest = policy.select(make_view(rows)).detail
        coarse = policy.select(make_view(rows, work_ms=times_ms)).detail
        assert (coarse >= finest).all()
        assert (coarse > finest).any()
        times_ms.append(fault)
        last = policy.select(make_view(rows, work_ms=times_ms, time_ns=10**9)).detail
        for second in range(2, 30):
            times_ms.append(fault)
            view = make_view(rows, work_ms=times_ms, time_ns=second * 10**9)
            assert (policy.select(view).detail >= last).all()


@pytest.mark.parametrize(
    "params",
    [{"min_scale": 0.0}, {"max_level": -1}, {"samples": 0}, {"delay_s": -1.0}, {"retry_s": np.nan}],
)
def test_senseless_parameters_are_refused(rows: Scene, params: dict[str, Any]) -> None:
    """A parameter out of its range is bad input."""
    with pytest.raises(InputError, match=f"unity-adaptive: expected .*{next(iter(params))}.*, got"):
        UnityAdaptive(**params).reset(rows, 10.0)
