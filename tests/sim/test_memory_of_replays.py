"""Memory that a replay takes, by the length of its path and the size of its scene."""

import gc
import tracemalloc
from collections.abc import Callable

import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.thresholds.static_screen import StaticScreen
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

BYTES_A_FRAME = 500.0
SHORT, LONG = 5_000, 45_000


@pytest.mark.slow
def test_a_long_path_takes_few_bytes_a_frame(
    make_scene: Callable[..., Scene],
    make_hardware: Callable[..., HardwareProfile],
    make_trace: Callable[..., CameraTrace],
) -> None:
    """Of two replays at 60 Hz, the one of 40,000 frames more peaks at most 500 bytes a frame above.

    Ten hours are 2.2 million frames, and would take 1.1 GB.
    """
    scene = make_scene([(0.0, 0.0, -10.0), (1.0, 0.0, -20.0)])
    trace = make_trace([(0.0, 0.0, 0.0), (0.0, 0.0, 1.0)], time_s=[0.0, LONG / 60.0])
    hardware = make_hardware(mode="vsync")

    def peak_bytes(frames: int) -> int:
        gc.collect()
        tracemalloc.start()
        try:
            options = ReplayOptions(budget_ms=16.0, frames=frames)
            log = replay(StaticScreen(), scene, trace, hardware, options, name="static-screen")
            assert len(log) == frames
            return tracemalloc.get_traced_memory()[1]
        finally:
            tracemalloc.stop()

    peak_bytes(10)  # what is loaded once, and not for each frame
    slope = (peak_bytes(LONG) - peak_bytes(SHORT)) / (LONG - SHORT)
    print(f"\n{slope:.0f} bytes a frame")
    assert slope <= BYTES_A_FRAME
