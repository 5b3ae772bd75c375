"""Write frame timings as PresentMon CSV, in the current dialect.

The current dialect, because it is what PresentMon writes today and the only one that has both the
times of version 1 by which most viewers go (``MsBetweenPresents``, ``MsUntilDisplayed``) and those
of version 2 (``MsCPUBusy``, ``MsGPUBusy``, ``MsAnimationError``).  These are the 28 columns of a
run without extra trackers.  Numbers have the digits of a nanosecond.
"""

import csv
import math
from pathlib import Path

import numpy as np

from ...base.arrays import FloatArray
from ...base.files.whole_file import whole_text_file
from .timings import FrameTimings

_MISSING = "NA"


def write_presentmon(
    path: str | Path, timings: FrameTimings, *, sync_interval: int = 0, tearing: bool = False
) -> None:
    """Write one stream.

    Raises `InputError` if the file cannot be written.

    Parameters
    ----------
    sync_interval, tearing
        What the program asked of Present(), the same in each row.
    """
    columns = _columns(timings)
    stream = {
        "Application": timings.application,
        "ProcessID": timings.process_id,
        "SwapChainAddress": timings.swap_chain,
        "PresentRuntime": "Other",
        "SyncInterval": sync_interval,
        "PresentFlags": 0,
        "AllowsTearing": int(tearing),
        "PresentMode": "Other",
    }
    with whole_text_file(Path(path)) as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow([*stream, *columns])
        same = list(stream.values())
        rows.writerows([*same, *row] for row in zip(*columns.values(), strict=True))


def _columns(timings: FrameTimings) -> dict[str, list[str]]:
    nothing = np.full(len(timings), np.nan)
    gpu_wait = timings.gpu_time_ms - timings.gpu_busy_ms
    animation_ms = np.where(timings.dropped, np.nan, timings.cpu_start_s * 1e3)
    columns = {
        "TimeInSeconds": timings.present_s,
        "MsBetweenSimulationStart": nothing,
        "MsBetweenPresents": timings.between_presents_ms,
        "MsBetweenDisplayChange": timings.between_display_change_ms,
        "MsInPresentAPI": timings.in_present_ms,
        "MsRenderPresentLatency": timings.until_render_complete_ms,
        "MsUntilDisplayed": timings.until_displayed_ms,
        "CPUStartTimeInSeconds": timings.cpu_start_s,
        "MsBetweenAppStart": timings.frame_ms,
        "MsCPUBusy": timings.cpu_busy_ms,
        "MsCPUWait": timings.in_present_ms,
        "MsGPULatency": timings.gpu_latency_ms,
        "MsGPUTime": timings.gpu_time_ms,
        "MsGPUBusy": timings.gpu_busy_ms,
        "MsGPUWait": np.maximum(gpu_wait, 0.0),
        "MsAnimationError": timings.animation_error_ms,
        "AnimationTime": animation_ms,
        "MsFlipDelay": nothing,
        "MsAllInputToPhotonLatency": timings.input_to_photon_ms,
        "MsClickToPhotonLatency": nothing,
    }
    return {
        name: _texts(values, 9 if name.endswith("InSeconds") else 6)
        for name, values in columns.items()
    }


def _texts(values: FloatArray, digits: int) -> list[str]:
    return [_MISSING if math.isnan(value) else f"{value:.{digits}f}" for value in values.tolist()]
