"""What the CPU learns of frame times: late, and faulty if asked for; and the noise of the times."""

from collections.abc import Callable

import numpy as np

from ...base.arrays import FloatArray
from ...policies.frame_times import Completed
from ..pipeline.pipeline import Pipeline
from ..pipeline.screens import DROPPED_NS
from .faults import Faults, Report

_BLOCK = 1024


class FrameNoise:
    """One random number a frame, drawn in blocks; frame k gets the same one under every policy."""

    def __init__(
        self,
        draw: Callable[[np.random.Generator, int], FloatArray],
        seed: np.random.SeedSequence,
    ) -> None:
        self._draw = draw
        self._rng = np.random.default_rng(seed)
        self._block: list[float] = []
        self._at = 0

    def next(self) -> float:
        """Return the next frame's number."""
        if self._at == len(self._block):
            self._block = self._draw(self._rng, _BLOCK).tolist()
            self._at = 0
        self._at += 1
        return self._block[self._at - 1]


class FrameTimer:
    """Reports of work and present times, as they reach the policy.

    The report of frame j arrives once frame j + delay has completed on the GPU: with F frames in
    flight on a GPU-bound queue, frame t is selected on the report of frame t - F - delay.
    """

    def __init__(self, faults: Faults, delay: int, seed: np.random.SeedSequence) -> None:
        self._faults, self._delay = faults, delay
        self._faulty = faults != Faults()
        self._dice = FrameNoise(lambda rng, count: rng.random(count), seed)
        self._times = np.full((_BLOCK, 4), np.nan)
        self._before: Report | None = None
        self._reported = 0  # frames whose work times have been read
        self._presented = 0  # frames known to be shown or dropped
        self._last_shown_ns = -1
        self._pipeline: Pipeline | None = None

    def attach(self, pipeline: Pipeline) -> None:
        """Take times from this pipeline."""
        self._pipeline = pipeline

    def completed(self) -> Completed:
        """Return the reports that have arrived by now."""
        pipeline = self._pipeline
        assert pipeline is not None, "attach a pipeline before frames begin"
        count = max(0, pipeline.completed - self._delay)
        while self._reported < count:
            self._read(self._reported, pipeline)
            self._reported += 1
        self._read_presents(count, pipeline)
        return Completed(self._times, count)

    def _read(self, frame: int, pipeline: Pipeline) -> None:
        if frame == len(self._times):
            # A new array: views handed out earlier keep what they were shown.  By half, not to
            # twice the size, as ten hours of frames are to take little memory.
            times = np.empty((frame + frame // 2, 4))
            times[:frame] = self._times
            times[frame:] = np.nan
            self._times = times
        cpu_ms = (pipeline.cpu_end_ns[frame] - pipeline.input_ns[frame]) * 1e-6
        gpu_ms = (pipeline.gpu_end_ns[frame] - pipeline.gpu_start_ns[frame]) * 1e-6
        report = (cpu_ms, gpu_ms, max(cpu_ms, gpu_ms))
        if self._faulty:
            report = self._faults.report(report, self._before or report, self._dice.next())
            self._before = report
        # One by one: numpy makes an array of a tuple first.
        times = self._times
        times[frame, 0], times[frame, 1], times[frame, 2] = report

    def _read_presents(self, count: int, pipeline: Pipeline) -> None:
        display_ns = pipeline.display_ns
        while self._presented < count and display_ns[self._presented] != -1:
            shown_ns = display_ns[self._presented]
            if shown_ns != DROPPED_NS:
                if self._last_shown_ns >= 0:
                    self._times[self._presented, 3] = (shown_ns - self._last_shown_ns) * 1e-6
                self._last_shown_ns = shown_ns
            self._presented += 1
