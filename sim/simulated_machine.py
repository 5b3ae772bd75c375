"""The machine that a frame runs on: simulated here by cost models and noise.

`render.gl` has another, which draws the frame and measures.
"""

from collections.abc import Mapping
from typing import NamedTuple, Protocol

import numpy as np

from ..models.machine.cost import CostModel
from ..models.machine.hardware import HardwareProfile
from ..models.machine.residual import Residual
from ..policies.protocol import Truth
from ..policies.selection import Selection
from ..policies.view import View
from .accounting.switches import Drawn
from .frame_timer import FrameNoise


class Submitted(NamedTuple):
    """A frame as it is handed to the machine: the policy's choice, and what it comes to.

    Attributes
    ----------
    counts : dict of str to float
        By GPU and CPU predictor.
    gpu_ms : float
        What the true cost model says of them.
    """

    view: View
    selection: Selection
    drawn: Drawn
    counts: Mapping[str, float]
    gpu_ms: float


class FrameTimes(NamedTuple):
    """Milliseconds of a frame: the policy's share of the CPU, all of the CPU, the GPU."""

    select_ms: float
    cpu_ms: float
    gpu_ms: float


class Machine(Protocol):
    """What frames take their time on."""

    def begin(self) -> Truth | None:
        """Begin a frame; return what an oracle may know of it, None where nobody can."""
        ...

    def run(self, frame: Submitted) -> FrameTimes:
        """Return how long the frame that was begun takes."""
        ...


class SimulatedMachine:
    """Cost models times noise; frame k has the same noise under every policy."""

    def __init__(
        self,
        hardware: HardwareProfile,
        truth: CostModel,
        scatter: Residual,
        seeds: tuple[np.random.SeedSequence, np.random.SeedSequence],
    ) -> None:
        self._cpu, self._truth = hardware.cpu, truth
        self._gpu_noise = FrameNoise(scatter.factors, seeds[0])
        self._cpu_noise = FrameNoise(hardware.cpu_residual.factors, seeds[1])
        self._gpu_factor = 1.0

    def begin(self) -> Truth:
        """Draw the noise of the frame's GPU time."""
        self._gpu_factor = self._gpu_noise.next()
        return Truth(self._truth, self._gpu_factor)

    def run(self, frame: Submitted) -> FrameTimes:
        """Price the frame."""
        cpu_ms, select_ms = self._cpu.frame_ms(frame.counts)
        return FrameTimes(
            select_ms, cpu_ms * self._cpu_noise.next(), frame.gpu_ms * self._gpu_factor
        )
