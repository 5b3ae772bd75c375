"""Frames that are drawn deep are simulated on a machine with the recorder's CPU."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.validation.drawn_machine import as_drawn
from lodbench.analysis.validation.recorded_frames import Measured, frames_in_flight
from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.sim.frame_log import COUNTS

DEEP = {"frames_in_flight": "3"}


def test_the_gpu_keeps_what_the_submission_leaves(
    recorded: Callable[..., dict[str, tuple[Measured, ...]]],
    make_machine: Callable[..., HardwareProfile],
) -> None:
    """Frames of 16 ms, of which the device works 12: three quarters are left, in each draw too.

    The CPU takes as long as it took to submit, and the 2 ms before, in mean and spread.
    """
    hardware = make_machine()
    item = recorded(hardware, ("full",), (None,))["full"][0]
    n = len(item.frames)
    counts = {name: np.zeros(n) for name in item.counts} | {"triangles": np.full(n, 15_000.0)}
    assert hardware.gpu.counted_ms(counts)[0] == pytest.approx(16.0)
    worked = item.frames.counts.copy()
    worked[:, COUNTS.index("gpu_ms")] *= 12.0 / worked[:, COUNTS.index("gpu_ms")].mean()
    frames = replace(item.frames, counts=worked)
    submit_ms = frames["gpu_ms"] / 3.0
    item = replace(
        item, frames=frames, counts=counts, prepare_ms=np.full(n, 2.0), submit_ms=submit_ms
    )
    found = as_drawn(hardware, DEEP, [[item]])
    assert found.frames_in_flight == 3
    cpu_ms = 2.0 + submit_ms
    drawn_ms = found.cpu.base_ms * found.cpu_residual.factors(np.random.default_rng(2), 4000)
    assert drawn_ms.mean() == pytest.approx(cpu_ms.mean(), rel=0.01)
    assert drawn_ms.std() == pytest.approx(cpu_ms.std(), rel=0.1)
    assert found.gpu.counted_ms(counts)[0] == pytest.approx(12.0)
    assert found.posterior is not None
    assert hardware.posterior is not None
    assert found.posterior.linear_ms == pytest.approx(0.75 * hardware.posterior.linear_ms)
    free = {name: np.zeros(n) for name in counts}
    nothing = replace(hardware, gpu=CostModel.of(0.0, {"triangles": 1.0}))
    found = as_drawn(nothing, DEEP, [[replace(item, counts=free)]])
    assert found.gpu.unit_ms("triangles") == 1.0  # no frame is priced: there is no factor


def test_frames_that_are_waited_for_are_simulated_as_the_profile_has_them(
    recorded: Callable[..., dict[str, tuple[Measured, ...]]],
    make_machine: Callable[..., HardwareProfile],
) -> None:
    """Nothing overlaps, and all of a frame is the GPU's."""
    hardware = make_machine()
    passed = recorded(hardware, ("full",), (None,))["full"]
    assert as_drawn(hardware, {"frames_in_flight": "1"}, [passed]) == hardware


@pytest.mark.parametrize("text", ["", "two", "-1", "1.5", "²"])
def test_a_header_that_says_no_number_is_refused(text: str) -> None:
    """In one line: the file was edited."""
    with pytest.raises(InputError, match="expected a number of frames in flight in its header"):
        frames_in_flight({"frames_in_flight": text})
    assert frames_in_flight({}) == 1
