"""The machine that a frame runs on: simulated here by cost models and noise.

`sim.gl` has another, which draws the frame and measures.
"""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..base.predictors import LEVEL_PREDICTORS
from ..models.machine.cost import CostModel
from ..models.machine.hardware import HardwareProfile
from ..models.machine.residual import Residual
from ..policies.protocol import Truth
from ..policies.selection import Selection
from ..policies.view import View
from .accounting.accounting import Tally
from .accounting.extraction import Extraction
from .accounting.switches import Drawn
from .frame_timer import FrameNoise

_DRAW_CALLS = LEVEL_PREDICTORS.index("draw_calls")


@dataclass(frozen=True, slots=True)
class Submitted:
    """A frame as it is handed to the machine: the policy's choice, and what it comes to."""

    view: View
    selection: Selection
    drawn: Drawn
    tally: Tally
    extraction: Extraction


@dataclass(frozen=True, slots=True)
class FrameTimes:
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
        self._hardware, self._truth = hardware, truth
        self._cpu_unit_ms: list[float] = hardware.cpu.linear_ms.tolist()
        self._gpu_noise = FrameNoise(scatter.factors, seeds[0])
        self._cpu_noise = FrameNoise(hardware.cpu_residual.factors, seeds[1])
        self._gpu_factor = 1.0

    def begin(self) -> Truth:
        """Draw the noise of the frame's GPU time."""
        self._gpu_factor = self._gpu_noise.next()
        return Truth(self._truth, self._gpu_factor)

    def run(self, frame: Submitted) -> FrameTimes:
        """Price the frame."""
        work, extraction = frame.selection.work, frame.extraction
        units = (
            work.objects_visited,
            work.comparisons,
            work.iterations,
            extraction.levels,
            extraction.triangles,
            extraction.borrowed,
            float(frame.tally.level_counts[_DRAW_CALLS]),
            len(frame.view.scene),
        )
        terms = [ms * unit for ms, unit in zip(self._cpu_unit_ms, units, strict=True)]
        cpu_ms = self._hardware.cpu.base_ms + sum(terms)
        return FrameTimes(
            sum(terms[:3]), cpu_ms * self._cpu_noise.next(), frame.tally.gpu_ms * self._gpu_factor
        )
