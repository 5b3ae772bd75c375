"""The oracle, compared with enumeration, HiGHS and its own bound."""

import itertools
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.policies.bounds.oracle import Oracle
from lodbench.policies.protocol import Truth
from lodbench.sim.replay import ReplayOptions, replay

Make = Callable[..., Any]
COSTS = CostModel.of(1.0, {"triangles": 1e-3})
CHAIN = np.array([1000.0, 250.0, 50.0])


def told(policy: Oracle, scene: Any, budget_ms: float, gpu_factor: float = 1.0) -> Oracle:
    """Reset an oracle and tell it the truth about the next frame."""
    policy.reset(scene, budget_ms)
    policy.foresee(Truth(COSTS, gpu_factor))
    return policy


@pytest.mark.parametrize("budget_ms", [1.2, 1.5, 2.1, 2.6, 3.5])
def test_small_scenes_are_solved_exactly(
    budget_ms: float, make_scene: Make, make_view: Make
) -> None:
    """Of all combinations of levels within the budget none has more benefit."""
    scene = make_scene([(0.0, 0.0, -d) for d in (4.0, 7.0, 9.0)], importance=[1.0, 3.0, 5.0])
    view = make_view(scene)
    detail = told(Oracle(), scene, budget_ms).select(view).detail.astype(int)
    weight = view.area_px * scene.importance

    def benefit(levels: Any) -> float:
        return float(weight @ (1.0 - 0.5 / CHAIN[list(levels)]))

    affordable = [
        levels
        for levels in itertools.product(range(3), repeat=3)
        if 1.0 + 1e-3 * CHAIN[list(levels)].sum() <= budget_ms
    ]
    assert tuple(detail) in affordable
    assert benefit(detail) == pytest.approx(max(benefit(levels) for levels in affordable))


def test_the_truth_scales_the_budget(make_scene: Make, make_view: Make) -> None:
    """Knowing that the frame will take twice as long, it draws for half the budget."""
    scene = make_scene([(0.0, 0.0, -4.0)])
    view = make_view(scene)
    assert told(Oracle(), scene, 2.0).select(view).detail.tolist() == [0.0]
    assert told(Oracle(), scene, 2.0, 1.5).select(view).detail.tolist() == [1.0]


def test_hull_pass_serves_beyond_the_exact_size(make_scene: Make, make_view: Make) -> None:
    """With exact_up_to=0 the greedy hull pass keeps the budget and the order of size."""
    scene = make_scene([(0.0, 0.0, -4.0), (0.0, 0.0, -40.0)])
    detail = told(Oracle(exact_up_to=0), scene, 2.06).select(make_view(scene)).detail
    assert detail.tolist() == [0.0, 2.0]


def test_continuous_types_use_the_budget_up(
    make_scene: Make, make_levels: Make, make_view: Make
) -> None:
    """What is left of the budget raises a resolution between two knots."""
    levels = make_levels((tuple(CHAIN),), continuous=True)
    scene = make_scene([(0.0, 0.0, -4.0)], levels=levels)
    detail = told(Oracle(), scene, 1.5).select(make_view(scene)).detail
    assert detail.tolist() == pytest.approx([0.5])


def test_replay_keeps_every_frame_at_the_budget_and_below_the_bound(
    make_scene: Make, make_hardware: Make, make_trace: Make, make_levels: Make
) -> None:
    """In a replay with noise no frame is over budget and benefit never exceeds its bound."""
    from lodbench.models.machine.residual import Residual

    rng = np.random.default_rng(4)
    positions = np.column_stack((rng.uniform(-9, 9, (60, 2)), rng.uniform(-30, -3, 60)))
    hardware = make_hardware(residual=Residual("gaussian", 0.1))
    trace = make_trace([(0.0, 0.0, 0.0), (1.0, 0.0, -2.0)])
    for continuous in (False, True):
        scene = make_scene(positions, levels=make_levels((tuple(CHAIN),), continuous=continuous))
        options = ReplayOptions(budget_ms=9.0)
        log = replay(Oracle(), scene, trace, hardware, options, name="oracle")
        assert log.header.oracle
        assert (log["gpu_ms"] <= 9.0 + 1e-9).all()
        assert (log["benefit"] <= log["benefit_bound"] * (1.0 + 1e-12)).all()
        assert (log["benefit"] >= log["benefit_bound"] * 0.9999).all()


def test_an_oracle_that_was_told_nothing_says_so(make_scene: Make, make_view: Make) -> None:
    """Without the truth there is no selection."""
    scene = make_scene([(0.0, 0.0, -4.0)])
    policy = Oracle()
    policy.reset(scene, 5.0)
    with pytest.raises(InputError, match="call foresee"):
        policy.select(make_view(scene))
    with pytest.raises(InputError, match="exact_up_to in"):
        Oracle(exact_up_to=-1).reset(scene, 5.0)
