"""The bare pipeline against the same pipeline written in simpy, in one run."""

import time
from collections.abc import Callable, Generator
from typing import Any

import numpy as np
import pytest

from lodbench.models.machine.hardware import Display
from lodbench.sim.pipeline.pipeline import Pipeline

simpy: Any = pytest.importorskip("simpy", reason="simpy is only in the dependency group `bench`")

Process = Generator[Any, Any, None]
FRAMES = 20_000
IN_FLIGHT = 3
IMAGES = 3
PERIOD_NS = 10_000_000
TARGET = 5.0  # times the frames per second of simpy


class Script:
    """A source of frames with given costs."""

    def __init__(self, costs: list[tuple[int, int]]) -> None:
        self.costs = costs

    def begin(self, frame: int, time_ns: int) -> tuple[int, int] | None:
        """Return the costs of a frame."""
        return self.costs[frame] if frame < len(self.costs) else None


def run_ours(costs: list[tuple[int, int]], *, vsync: bool) -> list[int]:
    """Return display times of our pipeline."""
    mode = "vsync" if vsync else "immediate"
    display = Display(mode=mode, refresh_hz=100.0, images=IMAGES, latency_limit=0)
    pipeline = Pipeline(Script(costs), display, IN_FLIGHT)
    pipeline.run()
    return pipeline.display_ns.tolist()


def run_simpy(costs: list[tuple[int, int]], *, vsync: bool) -> list[int]:
    """Return display times of CPU, GPU and screen as processes, queues and slots of simpy."""
    environment = simpy.Environment()
    in_flight = simpy.Resource(environment, IN_FLIGHT)
    images = simpy.Container(environment, IMAGES, IMAGES)
    submitted, finished = simpy.Store(environment), simpy.Store(environment)
    display_ns = [0] * len(costs)

    def cpu() -> Process:
        for frame, (cpu_ns, _) in enumerate(costs):
            slot = in_flight.request()
            yield slot
            yield environment.timeout(cpu_ns)
            submitted.put((frame, slot))

    def show(frame: int) -> None:
        display_ns[frame] = environment.now
        if frame:  # the frame before leaves the screen, and its image is free
            images.put(1)

    def gpu() -> Process:
        while True:
            frame, slot = yield submitted.get()
            yield images.get(1)
            yield environment.timeout(costs[frame][1])
            in_flight.release(slot)
            if vsync:
                finished.put(frame)
            else:
                show(frame)

    def screen() -> Process:
        shown_ns = -PERIOD_NS
        while True:
            frame = yield finished.get()
            shown_ns = max(shown_ns + PERIOD_NS, -(-environment.now // PERIOD_NS) * PERIOD_NS)
            yield environment.timeout(shown_ns - environment.now)
            show(frame)

    environment.process(cpu())
    environment.process(gpu())
    if vsync:
        environment.process(screen())
    environment.run()
    return display_ns


def best_s(run: Callable[..., object], *arguments: Any, **keywords: Any) -> float:
    """Return the shortest processor time of five runs."""
    times: list[float] = []
    for _ in range(5):
        start = time.process_time()
        run(*arguments, **keywords)
        times.append(time.process_time() - start)
    return min(times)


@pytest.fixture(scope="module")
def costs() -> list[tuple[int, int]]:
    """Return random CPU and GPU nanoseconds about 6 and 8 ms."""
    rng = np.random.default_rng(1)
    cpu = rng.integers(2_000_000, 10_000_000, FRAMES)
    gpu = rng.integers(4_000_000, 12_000_000, FRAMES)
    return list(zip(cpu.tolist(), gpu.tolist(), strict=True))


@pytest.mark.parametrize("vsync", [False, True], ids=["immediate", "vsync"])
def test_both_pipelines_show_every_frame_at_the_same_nanosecond(
    costs: list[tuple[int, int]], vsync: bool
) -> None:
    """The peer is the same model, not a lighter one."""
    assert run_ours(costs, vsync=vsync) == run_simpy(costs, vsync=vsync)


@pytest.mark.parametrize("vsync", [False, True], ids=["immediate", "vsync"])
def test_the_pipeline_is_five_times_as_fast_as_simpy(
    benchmark: Any, costs: list[tuple[int, int]], vsync: bool
) -> None:
    """Frames per second of processor time, best of five of each."""
    peer_s = best_s(run_simpy, costs, vsync=vsync)
    own_s = best_s(run_ours, costs, vsync=vsync)
    benchmark.pedantic(run_ours, (costs,), {"vsync": vsync}, rounds=3)
    rates = {"frames_per_s": FRAMES / own_s, "simpy_frames_per_s": FRAMES / peer_s}
    benchmark.extra_info.update({**rates, "ratio": peer_s / own_s})
    print(f"\nours {FRAMES / own_s:,.0f}, simpy {FRAMES / peer_s:,.0f}: {peer_s / own_s:.2f} times")
    assert peer_s / own_s >= TARGET
