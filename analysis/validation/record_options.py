"""How frames are drawn and timed when they are recorded."""

import time
from dataclasses import dataclass

from ...base.errors import InputError
from ...render.gl.context import Device

CLOCKS = {"wall": time.perf_counter_ns, "thread": time.thread_time_ns}
"""What drawings are timed by: the wall's clock, or what the caller's thread works."""

_MOST_THREADS = 32  # of llvmpipe
_MOST_IN_FLIGHT = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordOptions:
    """How to draw.

    Attributes
    ----------
    backend : one of `context.BACKENDS`
    instancing : whether all instances of a level are drawn at once
    repeats : times that each frame is drawn
    threads : of llvmpipe, beside the caller's
    clock : of `CLOCKS`
    frames_in_flight : of a policy's replay; 0 waits for each drawing of a frame
    calibration_steps : poses along the trace that calibration draws
    """

    backend: str = "egl"
    instancing: bool = False
    repeats: int = 5
    threads: int = 0
    clock: str = "wall"
    frames_in_flight: int = 0
    calibration_steps: int = 1_200

    def __post_init__(self) -> None:
        if not 0 <= self.threads <= _MOST_THREADS:
            got = self.threads
            raise InputError(f"--threads: expected 0 to {_MOST_THREADS}, got {got}; 0 is quietest")
        if self.calibration_steps < 1:
            raise InputError(f"--steps: expected 1 or more, got {self.calibration_steps}")
        if self.clock not in CLOCKS:
            raise InputError(f"--clock: expected one of {', '.join(CLOCKS)}, got {self.clock}")
        if not 0 <= self.frames_in_flight <= _MOST_IN_FLIGHT:
            expected = f"1 to {_MOST_IN_FLIGHT}, or 0 to wait for each drawing"
            raise InputError(
                f"--frames-in-flight: expected {expected}, got {self.frames_in_flight}"
            )
        if self.frames_in_flight and self.clock == "thread":
            raise InputError(
                "--frames-in-flight: expected --clock wall, got thread; a thread's time stands "
                "still while the device is waited for"
            )

    def require_device(self, device: Device) -> None:
        """Raise InputError if a device cannot be timed in this way."""
        alone = device.caller_draws and self.threads == 0
        if self.clock == "thread" and not alone:
            raise InputError(
                "--clock thread: expected a renderer that draws in the caller's thread (llvmpipe "
                f"with --threads 0), got {device.renderer} with --threads {self.threads}; "
                "record with --clock wall"
            )
        if self.frames_in_flight and alone:
            raise InputError(
                "--frames-in-flight: expected a renderer that draws beside the caller's thread, "
                f"got {device.renderer} with --threads 0; record with --threads 1 or more"
            )
