"""The engine's policy keeps its budget, and what it claims."""

from collections.abc import Callable

import pytest
from lod_policy import FinestThatFits

from lodbench.sim.frame_log import FrameLog
from lodbench.testing import Property, parametrize_with_properties


def test_budget(assert_budget: Callable[..., None]) -> None:
    """The limits of limits.toml hold on paths that rest, step, turn and dash through a district."""
    assert_budget(FinestThatFits, "district", "trial")


@parametrize_with_properties([FinestThatFits], examples=50)
def test_properties(policy_factory: type[FinestThatFits], check_property: Property) -> None:
    """What the policy claims holds in worlds that hypothesis makes up."""
    check_property(policy_factory)


def test_full_detail_where_there_is_time(replay: Callable[..., FrameLog]) -> None:
    """A view along the edge of the plaza is drawn in full."""
    log = replay(FinestThatFits, "plaza", "tour", seconds=(0.0, 1.5))
    assert (log["benefit"] >= 0.999 * log["full_benefit"]).all()


@pytest.mark.lodbench_sweep
@pytest.mark.parametrize("seed", range(20))
def test_no_frame_takes_twice_the_budget(replay: Callable[..., FrameLog], seed: int) -> None:
    """A slow sweep, run at night with --lodbench-sweeps."""
    log = replay(FinestThatFits, "plaza", "dash", seed=seed)
    assert log["gpu_ms"].max() < 2.0 * log.header.budget_ms
