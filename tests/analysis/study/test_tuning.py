"""Knobs are brought to the budget on some paths and judged on others."""

import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Self

import numpy as np
import pytest

from lodbench.analysis.study.engine.task import Failure, Outcome
from lodbench.analysis.study.replays import Bench, Place, Replays
from lodbench.analysis.study.score import Scored
from lodbench.analysis.study.tuning import MOST_VALUES, SCANNED_PATHS, SCANNED_VALUES, rotate, tune
from lodbench.policies.knob import Knob
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions

KNOB = Knob("bias", 0.1, 10.0)
BUDGET_MS = 16.0


class MadeEngine:
    """An engine whose results are a formula of the knob and the path."""

    def __init__(self, work_ms: Callable[[float, int], float], scored: Callable[..., Scored]):
        self._work_ms, self._scored = work_ms, scored
        self.runs: list[Any] = []

    def run(self, tasks: Sequence[Any], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield results in the order opposite to that of the tasks: no order is promised."""
        for at in reversed(range(len(tasks))):
            run = tasks[at]
            self.runs.append(run)
            knob = float(run.policy.params["bias"])
            work_ms = self._work_ms(knob, int(run.trace))
            if math.isnan(work_ms):
                yield Outcome(at, None, Failure("failed", "made to fail"))
                continue
            yield Outcome(at, self._scored(judged_ms=work_ms))

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exception: object) -> None:
        pass


def make_replays(engine: MadeEngine, paths: int) -> Replays:
    """Return replays of one policy with a knob, on paths that are named by their number."""
    bench = Bench(
        inputs={},
        scene="scene",
        hardware="machine",
        paths=tuple(map(str, range(paths))),
        specs={"static-screen": parse_policy("static-screen")},
        knobs={"static-screen": KNOB},
        options=ReplayOptions(budget_ms=BUDGET_MS),
        warmup_s=1.0,
        miss=0.01,
    )
    return Replays(bench, engine)


def test_the_finest_knob_that_surely_keeps_the_budget_is_found(
    made_scored: Callable[..., Scored],
) -> None:
    """With work = 8 ms times the knob on every path, the budget of 16 is kept up to 2."""
    engine = MadeEngine(lambda knob, path: 8.0 * knob, made_scored)
    replays = make_replays(engine, 10)
    tuned = tune(replays, rotate(10, 0), BUDGET_MS, 0)["static-screen"]
    assert 2.0 / 1.06 < tuned.point.value <= 2.0
    assert tuned.point.keeps
    assert tuned.point.monotone
    assert set(tuned.judged.tolist()) == {tuned.point.value}
    assert SCANNED_VALUES < len(tuned.values) <= SCANNED_VALUES + 4  # fewer than halving takes
    places = {(run.policy.params["bias"], run.trace) for run in engine.runs}
    assert len(places) == len(engine.runs)  # each once, for all folds together
    whole = [value for value in tuned.values if (value, "9") in places]
    assert len(whole) <= 6  # only near the budget on all paths
    assert len(places) == SCANNED_PATHS * len(tuned.values) + (10 - SCANNED_PATHS) * len(whole)


@pytest.mark.parametrize("paths", [2, 4])
def test_few_paths_take_few_replays(made_scored: Callable[..., Scored], paths: int) -> None:
    """Where all paths are scanned, the point is known to a tenth from half of the replays."""
    engine = MadeEngine(lambda knob, path: 8.0 * knob, made_scored)
    tuned = tune(make_replays(engine, paths), rotate(paths, 0), BUDGET_MS, 0)["static-screen"]
    assert 2.0 / 1.1 < tuned.point.value <= 2.0
    assert len(tuned.values) <= SCANNED_VALUES
    assert len(engine.runs) == paths * len(tuned.values)


def test_a_path_takes_no_part_in_the_choice_of_its_own_knob(
    made_scored: Callable[..., Scored],
) -> None:
    """Path 0 is twice as heavy: only those of its fold are judged at a knob that is too fine.

    The others have it among 8 paths: ln of work has mean ln 2 / 8 and spread .245, and another path
    is surely below 1.415 * sqrt(1 + 1/8) spreads above the mean: 1.27 is the knob.
    """
    engine = MadeEngine(lambda knob, path: (2.0 if path == 0 else 1.0) * 8.0 * knob, made_scored)
    tuned = tune(make_replays(engine, 10), rotate(10, 0), BUDGET_MS, 0)["static-screen"]
    fold = [0, 5]  # path i is judged in turn i mod 5
    others = [path for path in range(10) if path not in fold]
    assert tuned.judged[fold] == pytest.approx([2.0, 2.0], rel=0.12)
    assert tuned.judged[others] == pytest.approx([1.27] * 8, rel=0.12)


def test_what_cannot_keep_the_budget_is_judged_where_it_misses_least(
    made_scored: Callable[..., Scored],
) -> None:
    """Work that never falls to the budget is least at the coarse end, and nothing is refined."""
    engine = MadeEngine(lambda knob, path: 20.0 + knob, made_scored)
    tuned = tune(make_replays(engine, 5), rotate(5, 0), BUDGET_MS, 0)["static-screen"]
    assert not tuned.point.keeps
    assert tuned.point.value == KNOB.low
    assert len(tuned.values) == SCANNED_VALUES


def test_a_knob_that_turns_back_is_scanned_whole(made_scored: Callable[..., Scored]) -> None:
    """Where a finer value keeps the budget beyond one that does not, it is found, and said so."""
    engine = MadeEngine(
        lambda knob, path: 30.0 if 0.2 < knob < 5.0 else 10.0 + 0.1 * knob, made_scored
    )
    tuned = tune(make_replays(engine, 5), rotate(5, 0), BUDGET_MS, 0)["static-screen"]
    assert tuned.point.value == KNOB.high
    assert not tuned.point.monotone


def test_one_path_is_tuned_on_its_variations_alone(made_scored: Callable[..., Scored]) -> None:
    """Variations that are heavier than the path decide its knob."""
    rotation = rotate(1, 3)
    assert (rotation.training, rotation.judged, rotation.sets) == ((1, 2, 3), (0,), ((1, 2, 3),))
    engine = MadeEngine(lambda knob, path: (1.0 if path == 0 else 4.0) * 8.0 * knob, made_scored)
    tuned = tune(make_replays(engine, 4), rotation, BUDGET_MS, 0)["static-screen"]
    assert 0.5 / 1.1 < tuned.judged[0] <= 0.5  # three paths: a bracket of a tenth
    assert {run.trace for run in engine.runs} == {"1", "2", "3"}


def test_a_policy_that_fails_while_it_is_tuned_fails(made_scored: Callable[..., Scored]) -> None:
    """It has no operating point, its failure is kept, and it is not replayed again."""
    engine = MadeEngine(lambda knob, path: math.nan if knob > 1.0 else 8.0, made_scored)
    replays = make_replays(engine, 5)
    assert tune(replays, rotate(5, 0), BUDGET_MS, 0) == {}
    assert str(replays.failures["static-screen"]) == "reset: made to fail"
    count = len(engine.runs)
    replays.make([Place("static-screen", 0, 7, 0.5)])
    assert len(engine.runs) == count


def test_noise_does_not_keep_the_search_going(made_scored: Callable[..., Scored]) -> None:
    """Paths and knobs with scatter of their own end within the most values."""
    noise = np.random.default_rng(3).lognormal(0.0, 0.3, (10, 1000))
    engine = MadeEngine(
        lambda knob, path: 8.0 * knob * noise[path, int(knob * 90.0) % 1000], made_scored
    )
    tuned = tune(make_replays(engine, 10), rotate(10, 0), BUDGET_MS, 0)["static-screen"]
    assert len(tuned.values) <= MOST_VALUES
    assert (np.diff(tuned.values) > 0.0).all()
