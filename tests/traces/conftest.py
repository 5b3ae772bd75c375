"""Fixtures of frame timings: a hand-worked stream, and what each dialect writes of it.

In milliseconds; the third frame is dropped::

    frame  CPUStart  Present()  GPU     busy  screen
    0       0         4.. 5      1.. 9    7     10
    1       5         9..12      9..16    7     20
    2      12        15..18     16..19    3      -
    3      18        22..25     20..27    5     30
    4      25        30..32     30..38    8     45

No row is written of frame 0, the first present of the swap chain.
"""

import pytest

_STREAM = "game.exe,7,0xABC,DXGI,0,0,0,Composed: Flip"

_V1 = f"""\
Application,ProcessID,SwapChainAddress,Runtime,SyncInterval,PresentFlags,AllowsTearing,PresentMode,\
Dropped,TimeInSeconds,msInPresentAPI,msBetweenPresents,msUntilRenderComplete,msUntilDisplayed,\
msBetweenDisplayChange,msUntilRenderStart,msGPUActive,msSinceInput
{_STREAM},0,0.009,3,5,7,11,10,0,7,2
{_STREAM},1,0.015,3,6,4,0,0,1,3,0
{_STREAM},0,0.022,3,7,5,8,10,-2,5,0
{_STREAM},0,0.030,2,8,8,15,15,0,8,4
"""

_V2 = f"""\
Application,ProcessID,SwapChainAddress,PresentRuntime,SyncInterval,PresentFlags,AllowsTearing,\
PresentMode,FrameType,CPUStartTime,FrameTime,CPUBusy,CPUWait,GPULatency,GPUTime,GPUBusy,GPUWait,\
DisplayLatency,DisplayedTime,AnimationError,AnimationTime,AllInputToPhotonLatency
{_STREAM},Application,5,7,4,3,4,7,7,0,15,10,-5,5,13
{_STREAM},Application,12,6,3,3,4,3,3,0,NA,NA,NA,NA,NA
{_STREAM},Application,18,7,4,3,2,7,5,2,12,15,3,18,NA
{_STREAM},Application,25,7,5,2,5,8,8,0,20,10,-8,25,19
"""

_CURRENT = f"""\
Application,ProcessID,SwapChainAddress,PresentRuntime,SyncInterval,PresentFlags,AllowsTearing,\
PresentMode,TimeInMs,MsBetweenSimulationStart,MsBetweenPresents,MsBetweenDisplayChange,\
MsInPresentAPI,MsRenderPresentLatency,MsUntilDisplayed,CPUStartTimeInMs,MsBetweenAppStart,MsCPUBusy,\
MsCPUWait,MsGPULatency,MsGPUTime,MsGPUBusy,MsGPUWait,MsAnimationError,AnimationTime,\
MsAllInputToPhotonLatency
{_STREAM},9,NA,5,10,3,7,11,5,7,4,3,4,7,7,0,-5,5,13
{_STREAM},15,NA,6,NA,3,4,NA,12,6,3,3,4,3,3,0,NA,NA,NA
{_STREAM},22,NA,7,10,3,5,8,18,7,4,3,2,7,5,2,3,18,NA
{_STREAM},30,NA,8,15,2,8,15,25,7,5,2,5,8,8,0,-8,25,19
"""

_NAN = float("nan")
_EXPECTED = {
    "present_s": [0.009, 0.015, 0.022, 0.030],
    "between_presents_ms": [5, 6, 7, 8],
    "frame_ms": [7, 6, 7, 7],
    "cpu_busy_ms": [4, 3, 4, 5],
    "in_present_ms": [3, 3, 3, 2],
    "gpu_latency_ms": [4, 4, 2, 5],
    "gpu_time_ms": [7, 3, 7, 8],
    "gpu_busy_ms": [7, 3, 5, 8],
    "until_render_complete_ms": [7, 4, 5, 8],
    "until_displayed_ms": [11, _NAN, 8, 15],
    "display_latency_ms": [15, _NAN, 12, 20],
    "between_display_change_ms": [10, _NAN, 10, 15],
    "displayed_ms": [10, _NAN, 15, _NAN],
    "animation_error_ms": [-5, _NAN, 3, -8],
    "input_to_photon_ms": [13, _NAN, _NAN, 19],
}


@pytest.fixture
def present_logs() -> dict[str, str]:
    """Return the stream as PresentMon writes it, by dialect."""
    return {"presentmon-v1": _V1, "presentmon-v2": _V2, "presentmon": _CURRENT}


@pytest.fixture
def expected_timings() -> dict[str, list[float]]:
    """Return the stream's timings, by column of `FrameTimings`, worked out by hand."""
    return {name: list(values) for name, values in _EXPECTED.items()}
