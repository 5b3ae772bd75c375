"""Whether a device's timer query can be believed."""

from collections.abc import Sequence

import numpy as np

from ..context import Device
from ..renderer import Timing

_LONGER = 1.05  # than the whole frame: the clocks differ a little
_WAITED = 0.5  # share of the wait for the frame's end that work on the device should fill
_LEAST_WAIT_MS = 0.2  # below which the wait is the driver's own


def doubt_timer(device: Device, timings: Sequence[Timing]) -> str | None:
    """Return why the query's times are no measurements, or None if nothing speaks against them.

    Known failures: a 32-bit counter that ran over in the first results, queries that are not
    supported and return 0, and software that answers before it has drawn.
    """
    gpu, cpu, frame = np.array([(t.gpu_ms, t.cpu_ms, t.frame_ms) for t in timings]).T
    if device.software:
        share = float(np.median(gpu / frame))
        return f"a software rasteriser draws in part outside of its query, here {1 - share:.0%}"
    if (gpu > _LONGER * frame).any():
        return f"{gpu.max():.1f} ms in a frame of {frame[gpu.argmax()]:.1f} ms: a counter ran over"
    if (gpu <= 0.0).any():
        return "0 ms: the query is not supported"
    if np.median(gpu) < _WAITED * np.median(frame - cpu) > _WAITED * _LEAST_WAIT_MS:
        return f"{np.median(gpu):.2f} ms where {np.median(frame - cpu):.2f} ms were waited for"
    return None
