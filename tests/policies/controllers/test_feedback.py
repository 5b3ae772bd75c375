"""Feedback: steps of the bias by hand, and timers that lie."""

import math
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lodbench.base.errors import InputError
from lodbench.models.scene.levels import LevelTable
from lodbench.models.scene.scene import Scene
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.view import View

BUDGET_MS = 10.0
Steer = Callable[..., list[float]]


@pytest.fixture(scope="module")
def steer(
    make_scene: Callable[..., Scene],
    make_levels: Callable[..., LevelTable],
    make_view: Callable[..., View],
) -> Steer:
    """Return a function that reports times one by one and gives the level after each.

    The one object is 0.2 of the screen high and has 200 levels, 1 % of height apart below 0.25:
    without hysteresis level i says that the bias lies in ``1.25 · 0.99^i``.
    """
    levels = make_levels([tuple(range(400, 200, -1))])
    scene = make_scene([(0.0, 0.0, -5.0)], levels=levels)

    def steered(
        policy: Feedback, reports: Sequence[float], frames_a_report: int = 1
    ) -> list[float]:
        policy.reset(scene, BUDGET_MS)
        counts = np.repeat(np.arange(len(reports) + 1), frames_a_report)
        levels, drawn = list[float](), None
        for frame, told in enumerate(counts.tolist()):
            last = np.nan if drawn is None else drawn.detail
            view = make_view(
                scene, work_ms=reports[:told], frame=frame, previous=drawn, detail=last
            )
            drawn = policy.select(view)
            levels.append(float(drawn.detail[0]))
        return levels

    return steered


def policy_of(**more: float) -> Feedback:
    """Return a feedback on fine steps: a ladder of 1 %, no hysteresis, target 10 ms."""
    return Feedback(**{"target": 1.0, "ratio": 0.99, "hysteresis": 0.0, **more})


def level_of(bias: float) -> int:
    """Return the level at which a height of 0.2 is drawn under a bias."""
    return max(0, math.ceil(math.log(0.2 * bias / 0.25) / math.log(0.99)))


def test_a_step_is_a_power_of_the_error(steer: Steer) -> None:
    """10.5 ms where 10 are wanted, gain 0.5 and no dead band: bias 1 / sqrt 1.05, then again."""
    got = steer(policy_of(dead_band=0.0), [10.5, 10.5])
    step = 1.05**-0.5
    assert got == [level_of(1.0), level_of(step), level_of(step**2)]


def test_the_target_is_a_share_of_the_budget(steer: Steer) -> None:
    """With a target of 0.9, 9 ms of a budget of 10 move nothing and 10 ms coarsen."""
    assert steer(policy_of(target=0.9, dead_band=0.0), [9.0, 9.0]) == [level_of(1.0)] * 3
    assert steer(policy_of(target=0.9), [10.0])[1] == level_of((10.0 / 9.0) ** -0.5)


def test_inside_the_dead_band_nothing_moves(steer: Steer) -> None:
    """With a dead band of 5 %, 9.51 to 10.49 ms are good; 10.6 ms is not."""
    assert steer(policy_of(), [9.51, 10.49, 10.0]) == [level_of(1.0)] * 4
    assert steer(policy_of(), [10.6])[1] > level_of(1.0)
    assert steer(policy_of(), [9.4])[1] < level_of(1.0)


def test_a_step_is_never_larger_than_the_rate_limit(steer: Steer) -> None:
    """1,000 ms and 0.01 ms change the bias by 10 % a frame, no more."""
    slow = steer(policy_of(), [1000.0, 1000.0])
    assert slow == [level_of(1.0), level_of(1.0 / 1.1), level_of(1.0 / 1.21)]
    assert steer(policy_of(), [0.01, 0.02]) == [level_of(1.0), level_of(1.1), level_of(1.21)]


def test_the_bias_stays_within_its_bounds(steer: Steer) -> None:
    """However long frames are too slow or too fast, the bias ends at its bound."""
    assert steer(policy_of(min_bias=0.5), [50.0] * 30)[-1] == level_of(0.5)
    assert steer(policy_of(max_bias=1.15), [1.0 + 0.01 * k for k in range(30)])[-1] == level_of(
        1.15
    )


def test_a_report_moves_the_bias_once(steer: Steer) -> None:
    """Frames that begin before another report has arrived leave the bias alone."""
    thrice = steer(policy_of(), [20.0, 20.0], frames_a_report=3)
    once = steer(policy_of(), [20.0, 20.0])
    assert thrice == [level for level in once for _ in range(3)]
    assert len(set(once)) == 3


@pytest.mark.parametrize("faulty", [math.nan, 0.0, -3.0, math.inf])
def test_a_faulty_time_moves_nothing(steer: Steer, faulty: float) -> None:
    """A timer that is missing, zero, negative or infinite after a stall does not raise detail."""
    assert steer(policy_of(), [faulty] * 5) == [level_of(1.0)] * 6
    good = steer(policy_of(), [15.0, 15.0, 15.0])
    mixed = steer(policy_of(), [15.0, faulty, 15.0, faulty, faulty, 15.0])
    assert [mixed[i] for i in (0, 1, 3, 6)] == good
    assert mixed[2] == mixed[1]


def test_a_stuck_timer_lowers_detail_but_soon_no_longer_raises_it(steer: Steer) -> None:
    """Below target what follows from it ends with the second step, above it never does."""
    steps = [level_of((10.0 / 9.0) ** (0.5 * min(k, 2))) for k in range(7)]
    assert steer(policy_of(), [9.0] * 6) == steps
    stuck = steer(policy_of(), [12.0, 12.0, 12.0])
    assert stuck == sorted(set(stuck))


@given(
    st.lists(st.one_of(st.floats(10.6, 500.0), st.sampled_from([math.nan, 0.0, -1.0])), max_size=30)
)
def test_faults_among_slow_frames_never_raise_detail(steer: Steer, reports: list[float]) -> None:
    """While every true time is over target, no mixture of faults makes a level finer."""
    levels = steer(policy_of(), reports)
    assert (np.diff(levels) >= 0).all()


@pytest.mark.parametrize(
    "wrong",
    [
        {"target": 0.0},
        {"target": 1.5},
        {"gain": -1.0},
        {"dead_band": -0.1},
        {"rate_limit": 0.9},
        {"min_bias": 0.0},
        {"max_bias": 0.5},
        {"gain": math.nan},
    ],
)
def test_impossible_parameters_are_refused(
    make_scene: Callable[..., Scene], wrong: dict[str, float]
) -> None:
    """Parameters that could not steer are errors."""
    with pytest.raises(InputError, match=f"feedback: expected {next(iter(wrong))} in"):
        Feedback(**wrong).reset(make_scene([(0.0, 0.0, -1.0)]), BUDGET_MS)
