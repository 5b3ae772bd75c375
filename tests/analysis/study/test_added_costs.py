"""Costs that nobody measured, added to the frames of a log by hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.study.added_costs import ADDED_COSTS, AddedCost, works_with_added
from lodbench.models.machine.cost import CostModel, CpuCostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.sim.frame_log import FrameLog


@pytest.fixture
def frames(make_log: Callable[..., FrameLog]) -> MeasuredFrames:
    """Return three frames of 10 ms GPU and 4 ms CPU time, with 0, 1 and 5 calls to draw."""
    log = make_log(
        gpu_ms=np.full(3, 10.0), cpu_ms=np.full(3, 4.0), draw_calls=np.array([0.0, 1.0, 5.0])
    )
    return MeasuredFrames(log)


def test_a_cost_on_one_side_shows_where_that_side_is_longer(
    frames: MeasuredFrames, machine: HardwareProfile
) -> None:
    """2 ms of CPU time each: 4 + 2 n, hidden below the GPU's 10 until it is 14."""
    cost = AddedCost("a driver", ("draw_calls",), gpu_ms=0.0, cpu_ms=2.0)
    ((name, work_ms),) = works_with_added(frames, machine, [cost])
    assert name == "a driver"
    assert work_ms.tolist() == [10.0, 10.0, 14.0]


def test_what_is_charged_is_charged_again(frames: MeasuredFrames, machine: HardwareProfile) -> None:
    """At 0.5 ms a call on the GPU, twice the cost is 0.5 ms more for each call."""
    charging = replace(machine, gpu=CostModel.of(0.0, {"draw_calls": 0.5}))
    twice = AddedCost("twice", ("draw_calls",), cpu_ms=0.0)
    ((_, work_ms),) = works_with_added(frames, charging, [twice])
    assert work_ms.tolist() == [10.0, 10.5, 12.5]


def test_what_is_not_counted_or_costs_nothing_is_not_tried(
    frames: MeasuredFrames, machine: HardwareProfile
) -> None:
    """A log without the count, and a machine without the cost, have nothing to price again."""
    free = replace(machine, gpu=CostModel.of(1.0, {}))
    costs = [
        AddedCost("unknown", ("no_such_count",), gpu_ms=1.0),
        AddedCost("nothing", ("draw_calls",), cpu_ms=0.0),
    ]
    assert list(works_with_added(frames, free, costs)) == []


def test_deciding_is_charged_again_by_all_that_it_counts(
    make_log: Callable[..., FrameLog], machine: HardwareProfile
) -> None:
    """100 visits of 10 µs and 3 iterations of 1 ms are 4 ms; with 4 ms of CPU that makes 8.

    A machine that charges nothing for deciding, which means "not measured", has nothing to double.
    """
    log = make_log(
        gpu_ms=np.array([5.0]),
        cpu_ms=np.array([4.0]),
        objects_visited=np.array([100.0]),
        comparisons=np.array([7.0]),
        iterations=np.array([3.0]),
    )
    deciding = [cost for cost in ADDED_COSTS if cost.name == "deciding at twice its cost"]
    charging = CpuCostModel.of(0.5, {"objects_visited": 0.01, "iterations": 1.0})
    frames = MeasuredFrames(log)
    ((_, work_ms),) = works_with_added(frames, replace(machine, cpu=charging), deciding)
    assert work_ms.tolist() == [8.0]
    free = replace(machine, cpu=CpuCostModel.of(0.5, {}))
    assert list(works_with_added(frames, free, deciding)) == []


def test_a_bandwidth_is_tried_where_uploads_are_free(
    frames: MeasuredFrames, machine: HardwareProfile
) -> None:
    """Who charges for calls has a price of its own; who does not gets 2 ms each."""
    cost = AddedCost("a price", ("draw_calls",), gpu_ms=2.0, cpu_ms=0.0, where_free=True)
    charging = replace(machine, gpu=CostModel.of(0.0, {"draw_calls": 0.5}))
    assert list(works_with_added(frames, charging, [cost])) == []
    free = replace(machine, gpu=CostModel.of(0.0, {}))
    ((_, work_ms),) = works_with_added(frames, free, [cost])
    assert work_ms.tolist() == [10.0, 12.0, 20.0]
