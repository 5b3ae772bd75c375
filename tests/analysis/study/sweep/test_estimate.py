"""What a study would take, by hand from what was timed."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Self

import pytest

import lodbench
from lodbench.analysis.study.engine.task import Failure, Outcome
from lodbench.analysis.study.score import Scored
from lodbench.analysis.study.study import Study
from lodbench.analysis.study.sweep.estimate import FRAMES, estimate


class Timed:
    """An engine in which a replay of n frames takes n milliseconds, and hoppe fails in 0.5 s."""

    def __init__(self, sample: Scored) -> None:
        self._sample = sample
        self.asked: list[Any] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        pass

    def run(self, tasks: Sequence[Any], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield an outcome for each task, the first of each kind as slow as a cold start is."""
        assert not stop
        self.asked = list(tasks)
        for index, task in enumerate(tasks):
            cold_s = 0.0 if index % 2 else 100.0
            if task.policy.label == "hoppe":
                yield Outcome(index, None, Failure("failed", "no"), took_s=cold_s + 0.5)
                continue
            frames = task.options.frames
            scored = replace(self._sample, frames=frames)
            yield Outcome(index, scored, None, took_s=cold_s + 1e-3 * frames)


@pytest.fixture(scope="module")
def sample(made_scored: Callable[..., Scored]) -> Scored:
    """Return scores with the log of a replay of as many frames as a sample has."""
    given: dict[str, Any] = {"budget_ms": 16.0, "frames": FRAMES}
    log = lodbench.replay("full", "plaza", "walk", "desktop-assumed", **given)
    return replace(made_scored(), log=log)


def test_a_path_is_as_long_as_its_sample_says(sample: Scored) -> None:
    """By hand: the sample's 0.3 s, times the path over what it covers of it, times runs."""
    study = Study(["full", "hoppe"], traces="walk", seeds=10)
    engine = Timed(sample)
    found = estimate(study, engine)
    path_s = study.inputs[next(study.runs()).trace].duration_s
    assert sample.log is not None
    covered_s = 1e-9 * float(sample.log["input_ns"][-1])
    assert covered_s < path_s
    whole_s = 1e-3 * FRAMES * path_s / covered_s
    assert found.run_s == pytest.approx(10 * whole_s + 10 * 0.5)
    assert (found.runs, found.sampled, found.kinds) == (20, 2, 2)
    # So few frames may not outlast a warm-up.
    assert {(task.options.frames, task.warmup_s) for task in engine.asked} == {(FRAMES, 0.0)}


def test_a_path_shorter_than_the_sample_is_sampled_as_it_is(sample: Scored) -> None:
    """Of a path that ends before so many frames the whole was timed: it takes no longer."""
    study = Study("full", traces="walk", seconds=(0.0, 1.0), warmup_s=0.1, seeds=3)
    assert estimate(study, Timed(sample)).run_s == pytest.approx(3 * 1e-3 * FRAMES)


def test_disk_grows_with_the_runs(sample: Scored) -> None:
    """Ten times the runs need more, and no more than ten times as much."""
    few, many = (
        estimate(Study("full", traces="walk", seeds=seeds), Timed(sample)).disk_bytes
        for seeds in (100, 1000)
    )
    assert few < many <= 10 * few
