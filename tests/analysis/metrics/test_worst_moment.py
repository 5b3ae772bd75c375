"""The worst moment of a run, and which cost had grown there, by hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.worst_moment import find_worst_moment
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.machine.knee import Knee
from lodbench.sim.frame_log import FrameLog


@pytest.mark.parametrize(
    ("knees", "term", "grown_ms"),
    [((), "draw_calls", 4.0), ((Knee("triangles", 200.0, 0.05),), "triangles", 2.0 + 5.0)],
)
def test_what_had_grown_is_the_line_and_its_knees(
    knees: tuple[Knee, ...],
    term: str,
    grown_ms: float,
    make_log: Callable[..., FrameLog],
    machine: HardwareProfile,
) -> None:
    """200 triangles more at 10 µs are 2 ms, and 5 more where 100 of them lie beyond a knee.

    Four calls more at 1 ms are 4 ms, which is most without the knee.
    """
    log = make_log(
        gpu_ms=np.array([10.0, 10.0, 20.0]),
        cpu_ms=np.full(3, 4.0),
        triangles=np.array([100.0, 100.0, 300.0]),
        draw_calls=np.array([1.0, 1.0, 5.0]),
    )
    linear = {"triangles": 0.01, "draw_calls": 1.0}
    hardware = replace(machine, gpu=CostModel.of(0.0, linear, knees=knees))
    moment = find_worst_moment(MeasuredFrames(log), hardware)
    assert (moment.work_ms, moment.usual_ms) == (20.0, 10.0)
    assert (moment.term, moment.grown_ms) == (term, pytest.approx(grown_ms))
