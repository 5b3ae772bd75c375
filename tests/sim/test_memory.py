"""Memory of a replay: under 420 bytes an object and 500 a frame, beside half a megabyte.

A scene alone is some 120 bytes an object; blocks for culling and what is kept of candidates from
frame to frame are twice that, and what they spare in time is worth it.
"""

import gc
import tracemalloc
from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.thresholds.static_distance import StaticDistance
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.generators.generate import generate

OBJECT_BYTES, FRAME_BYTES, FIXED_BYTES = 420, 500, 500_000


@pytest.fixture
def measured(
    make_scene: Callable[..., Scene], make_hardware: Callable[..., HardwareProfile]
) -> Callable[[int, int], tuple[int, int, int]]:
    """Return a function from objects and frames to bytes: scene, peak with it, log at the end."""

    def measure(objects: int, frames: int) -> tuple[int, int, int]:
        rng = np.random.default_rng(1)
        places = np.column_stack([rng.uniform(-200, 200, (objects, 2)), np.ones(objects)])
        trace = generate("walk", duration_s=20.0, extent_m=80.0, seed=3)
        hardware = make_hardware({"triangles": 1e-6}, width_px=1280, height_px=720)
        options = ReplayOptions(budget_ms=16.0, frames=frames)
        tracemalloc.start()
        try:
            scene = make_scene(places)
            scene_bytes = tracemalloc.get_traced_memory()[0]
            log = replay(StaticDistance(), scene, trace, hardware, options, name="x")
            peak = tracemalloc.get_traced_memory()[1]
            gc.collect()  # of the simulator, whose parts know each other
            now = tracemalloc.get_traced_memory()[0]
        finally:
            tracemalloc.stop()
        assert len(log) == frames
        return scene_bytes, peak, now - scene_bytes

    return measure


@pytest.mark.slow
@pytest.mark.parametrize(("objects", "frames"), [(100_000, 50), (3_000, 8_000), (20_000, 2_000)])
def test_peak_memory(
    measured: Callable[[int, int], tuple[int, int, int]], objects: int, frames: int
) -> None:
    """The peak, scene included, is within the bound of its objects and frames."""
    scene, peak, kept = measured(objects, frames)
    print(
        f"{objects} objects, {frames} frames: scene {scene / objects:.0f} B an object, "
        f"peak {peak:,}, log {kept / frames:.0f} B a frame"
    )
    assert peak < OBJECT_BYTES * objects + FRAME_BYTES * frames + FIXED_BYTES


def test_a_frame_log_is_kept_in_500_bytes_a_frame(
    measured: Callable[[int, int], tuple[int, int, int]],
) -> None:
    """What a replay leaves behind is its columns, and no copy of them."""
    _, _, kept = measured(10, 3_000)
    assert kept < FRAME_BYTES * 3_000
