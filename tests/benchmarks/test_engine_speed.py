"""Two worker processes beside one, and what the engine adds to runs: ratios in one run."""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import pytest

from lodbench.analysis.study.engine.limits import count_processors
from lodbench.analysis.study.engine.local.local_engine import LocalEngine

RUNS = 200
OWNERS = ("a", "b", "c", "d")
SPEEDUP = 1.85
OVERHEAD = 0.25
"""Of runs of some 20 ms, at most: 5 ms a run."""


@dataclass(frozen=True)
class Computes:
    """A run of some 20 ms of arithmetic, which tells its process, and processor time around it."""

    owner: str
    rounds: int

    result_type: ClassVar[Any] = tuple[int, float, float]

    def __call__(self, inputs: Any, beat: Callable[[int], None]) -> tuple[int, float, float]:
        """Compute."""
        began_s = time.process_time()
        for frame in range(20):
            beat(frame)
            sum(i * i for i in range(self.rounds))
        return os.getpid(), began_s, time.process_time()


@dataclass(frozen=True)
class Measured:
    """What 200 runs took.

    Attributes
    ----------
    wall_s : float
    inside_s : float
        Processor time in the runs themselves.
    outside_s : float
        Processor time of the engine, and of its workers between runs.
    """

    wall_s: float
    inside_s: float
    outside_s: float


def measure(workers: int) -> Measured:
    """Run 200 runs of four policies; starts of processes are left out."""
    tasks = [Computes(OWNERS[i % len(OWNERS)], 24_000) for i in range(RUNS)]
    with LocalEngine({}, workers) as engine:
        list(engine.run([Computes(owner, 1) for owner in OWNERS[:workers]]))
        began_s, own_s = time.perf_counter(), time.process_time()
        results = [outcome.result for outcome in engine.run(tasks)]
        wall_s, own_s = time.perf_counter() - began_s, time.process_time() - own_s
    inside_s = sum(end - begin for _, begin, end in results)
    pids = {pid for pid, _, _ in results}
    spans = [[time for pid, *times in results if pid == one for time in times] for one in pids]
    working_s = sum(max(times) - min(times) for times in spans)
    return Measured(wall_s, inside_s, own_s + working_s - inside_s)


@pytest.mark.skipif(count_processors() < 2, reason="two workers need two processors")
def test_two_workers_are_nearly_twice_as_fast() -> None:
    """200 runs of four policies: the same work in little more than half of the time."""
    ratios = [measure(1).wall_s / measure(2).wall_s for _ in range(3)]
    assert max(ratios) >= SPEEDUP, ratios


def test_the_engine_adds_little_to_a_run() -> None:
    """Processor time outside of the runs, of 200 runs of four policies, beside that in them."""
    measured = measure(1)
    assert measured.outside_s <= OVERHEAD * measured.inside_s, measured
