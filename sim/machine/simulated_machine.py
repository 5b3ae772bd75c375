"""The machine that a frame runs on: simulated here by cost models and noise.

`render.gl` has another, which draws the frame and measures.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple, Protocol

import numpy as np

from ...base.arrays import FloatArray
from ...models.machine.cost import CostModel
from ...models.machine.hardware import HardwareProfile
from ...models.machine.residual import Residual
from ...policies.protocol import Truth
from ...policies.selection import Selection
from ...policies.view import View
from ..accounting.switches import Drawn
from .frame_timer import FrameNoise
from .slow_state import SlowState


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
    """Cost models times noise, which is the same under every policy.

    Fast noise and spikes are those of the k-th frame, a slow state is that of the time at which a
    frame begins: who takes half the time for a frame meets a slow second with twice the frames.
    """

    def __init__(
        self,
        hardware: HardwareProfile,
        truth: CostModel,
        residual: Residual,
        seeds: tuple[np.random.SeedSequence, np.random.SeedSequence],
        clock: Callable[[], int],
    ) -> None:
        self._cpu, self._truth, self._clock = hardware.cpu, truth, clock
        self._gpu_noise, self._gpu_state = _noise(residual, seeds[0])
        self._cpu_noise, self._cpu_state = _noise(hardware.cpu_residual, seeds[1])
        self._gpu_factor = 1.0

    def begin(self) -> Truth:
        """Draw the noise of the frame's GPU time."""
        self._gpu_factor = self._gpu_noise.next()
        if self._gpu_state is not None:
            self._gpu_factor *= self._gpu_state.at(self._clock())
        return Truth(self._truth, self._gpu_factor)

    def run(self, frame: Submitted) -> FrameTimes:
        """Price the frame."""
        cpu_ms, select_ms = self._cpu.frame_ms(frame.counts)
        cpu_ms *= self._cpu_noise.next()
        if self._cpu_state is not None:
            cpu_ms *= self._cpu_state.at(self._clock())
        return FrameTimes(select_ms, cpu_ms, frame.gpu_ms * self._gpu_factor)


def _noise(residual: Residual, seed: np.random.SeedSequence) -> tuple[FrameNoise, SlowState | None]:
    """Return the noise by frame and the state by time; either leaves the other as it is."""
    of_state, of_spikes = seed.spawn(2)
    state = SlowState(residual, of_state) if residual.slow_scale > 0.0 else None
    if residual.spike_share == 0.0:
        return FrameNoise(residual.factors, seed), state
    spikes = np.random.default_rng(of_spikes)

    def spiked(rng: np.random.Generator, count: int) -> FloatArray:
        return residual.factors(rng, count) * residual.spikes(spikes, count)

    return FrameNoise(spiked, seed), state
