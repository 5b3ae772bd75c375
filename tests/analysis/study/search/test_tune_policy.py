"""A search finds the parameters that are best, and says so when nothing is better than shipped."""

import math
from collections.abc import Callable, Iterator, Sequence
from types import TracebackType
from typing import Any, Self

import pytest

from lodbench.analysis.study.compare import CompareSettings
from lodbench.analysis.study.engine.task import Failure, Outcome
from lodbench.analysis.study.paths import load_paths
from lodbench.analysis.study.score import Scored
from lodbench.analysis.study.search import tune_policy as module
from lodbench.analysis.study.search.drawn_paths import Paths, draw_paths
from lodbench.analysis.study.search.tune_policy import tune_policy
from lodbench.analysis.study.search.tuning_record import Tuning
from lodbench.base.content_hash import content_hash
from lodbench.base.errors import InputError, PolicyError
from lodbench.base.files.strict_json import encode_record
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.policy_spec import PolicySpec
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.vary import vary

BUDGET_MS = 16.0
REPLAY = ReplayOptions(budget_ms=BUDGET_MS)
Made = Callable[..., Scored]


class MadeEngine:
    """An engine whose results are a formula of the knob, the searched parameter, and the path.

    The formula gives work (ms) and visible error (px); work that is NaN is a failure.
    """

    def __init__(
        self, formula: Callable[[float, float, int], tuple[float, float]], scored: Made
    ) -> None:
        self._formula, self._scored = formula, scored
        self.number: dict[str, int] = {}
        self.replayed: list[tuple[str, int]] = []

    def run(self, tasks: Sequence[Any], *, stop: bool = True) -> Iterator[Outcome]:
        """Yield results in the order opposite to that of the tasks."""
        for at in reversed(range(len(tasks))):
            run = tasks[at]
            given = run.policy.params
            knob, ratio = given.get("bias", math.inf), float(given.get("ratio", 0.5))
            path = self.number[run.trace]
            self.replayed.append((run.policy.label, path))
            if ratio > 0.9:
                raise InputError("expected ratio <= 0.9")
            work_ms, error_px = self._formula(float(knob), ratio, path)
            if math.isnan(work_ms):
                yield Outcome(at, None, Failure("failed", "made to fail", 7))
                continue
            scored = self._scored(
                judged_ms=work_ms,
                work_ms_mean=work_ms,
                visible_error_px=error_px,
                visible_pops_per_s=0.0,
            )
            yield Outcome(at, scored)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        pass


@pytest.fixture
def search(
    small_scene: Scene,
    turn_trace: CameraTrace,
    machine: HardwareProfile,
    monkeypatch: pytest.MonkeyPatch,
) -> Callable[..., Tuning]:
    """Return a search over `ratio` on a made engine; paths 0 to 9 judge, 10 to 19 train."""
    made = tuple(vary(turn_trace, number) for number in range(20))
    paths = Paths(training=made[10:], judged=made[:10])

    def run(engine: MadeEngine, *over: str, trials: int = 16) -> Tuning:
        engine.number = {content_hash(path): number for number, path in enumerate(made)}

        def open_made(inputs: object, **settings: object) -> MadeEngine:
            return engine

        monkeypatch.setattr(module, "open_engine", open_made)
        spec = parse_policy("static-screen")
        names = over or ("ratio=0.15:0.95",)
        return tune_policy(spec, names, small_scene, paths, machine, REPLAY, trials=trials)

    return run


def test_the_best_parameter_is_found_at_the_budget(
    made_scored: Made, search: Callable[..., Tuning]
) -> None:
    """Error is 20 |ratio - .3| over the knob, work 2 ms times the knob on each path.

    Shipped ratio .5 at knob 8 has 4 / 8 = .5 px; ratio .3 has none, and the nearest of 16 points
    lies within .05 of it: at most .125 px.  With half a pixel of error that all paths share the
    difference is beyond the margin of .25.
    """

    def formula(knob: float, ratio: float, path: int) -> tuple[float, float]:
        return 2.0 * knob, 20.0 * abs(ratio - 0.3) / knob + 0.01 * path

    engine = MadeEngine(formula, made_scored)
    found = search(engine)
    assert found.better
    assert found.found is not None
    ratio = found.found.params["ratio"]
    assert isinstance(ratio, float)
    assert abs(ratio - 0.3) <= 0.05
    assert (found.shipped.rank, found.found.rank) == (2, 1)
    knob = found.found.params["bias"]
    assert isinstance(knob, float)
    assert 8.0 / 1.06 < knob <= 8.0
    assert found.policy_line == f"static-screen:ratio={ratio},bias={knob}"
    gain = {one.metric: one for one in found.gain}["visible_error_px"]
    truth = 20.0 * (abs(ratio - 0.3) - 0.2) / knob
    assert gain.difference == pytest.approx(truth, abs=0.02)
    # All paths differ by as much: the interval is a point, where an unpaired one would be .05 wide.
    assert gain.interval[1] - gain.interval[0] < 1e-9
    # Seldom are all trials worth a replay on all paths.
    last = {label for label, path in engine.replayed if path == 19}
    assert len(last) <= 4


def test_what_cannot_be_bettered_is_said_to_be_so(
    made_scored: Made, search: Callable[..., Tuning]
) -> None:
    """The shipped ratio of .5 is the best there is: no trial is told to be better."""
    found = search(
        MadeEngine(lambda knob, ratio, path: (knob, 9.0 * abs(ratio - 0.5)), made_scored)
    )
    assert not found.better
    assert found.answer.startswith("No better than shipped")
    assert "ratio" not in found.policy_line


def test_luck_on_the_training_paths_is_no_gain(
    made_scored: Made, search: Callable[..., Tuning]
) -> None:
    """One trial has no error on the paths of the search and 5 px on others: it is not taken."""
    found = search(
        MadeEngine(
            lambda knob, ratio, path: (knob, 0.0 if path >= 10 and ratio < 0.3 else 5.0),
            made_scored,
        )
    )
    assert found.found is not None, "it came first in the search"
    assert found.found.params["ratio"] < 0.3  # type: ignore[operator]
    assert not found.better
    assert found.gain[1].difference == 0.0


def test_a_gain_within_the_margin_is_none(made_scored: Made, search: Callable[..., Tuning]) -> None:
    """A fifth of a pixel is seen by nobody, though each path shows it."""
    found = search(
        MadeEngine(lambda knob, ratio, path: (10.0, 0.2 if ratio >= 0.45 else 0.0), made_scored)
    )
    assert not found.better


def test_who_keeps_the_budget_is_better_than_who_does_not(
    made_scored: Made, search: Callable[..., Tuning]
) -> None:
    """Work does not fall below 20 ms with the shipped ratio; below .3 it is 10, at 3 px more."""
    found = search(
        MadeEngine(
            lambda knob, ratio, path: (10.0, 4.0) if ratio < 0.3 else (20.0 + 0.1 * path, 1.0),
            made_scored,
        )
    )
    assert found.better
    assert found.shipped.rank is None
    assert "surely keeps the budget" in found.answer


def test_without_a_knob_the_parameters_themselves_keep_the_budget(
    made_scored: Made, search: Callable[..., Tuning], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Work is 40 ms times the ratio: .5 takes 20, and the finest that keeps 16 is below .4."""

    def no_knob(spec: PolicySpec) -> None:
        return None

    monkeypatch.setattr(module, "declared_knob", no_knob)
    found = search(
        MadeEngine(lambda knob, ratio, path: (40.0 * ratio, 9.0 * (1.0 - ratio)), made_scored)
    )
    assert found.better
    assert found.found is not None
    assert found.found.knob is not None
    assert not found.found.knob.tuned
    ratio = found.found.params["ratio"]
    assert isinstance(ratio, float)
    # One of the 16 points is in [.35, .4]; a margin of 10 % of some 5.6 px is .06 of the ratio.
    assert 0.28 < ratio <= 0.4
    assert found.policy_line == f"static-screen:ratio={ratio}"


def test_trials_that_are_refused_or_fail_are_left_out(
    made_scored: Made, search: Callable[..., Tuning]
) -> None:
    """A ratio above .9 is refused, one above .8 fails: each trial says so, the rest are judged."""
    found = search(
        MadeEngine(
            lambda knob, ratio, path: (math.nan if ratio > 0.8 else knob, abs(ratio - 0.5)),
            made_scored,
        )
    )
    status = {trial.params.get("ratio", 0.5): trial.status for trial in found.trials}
    for ratio, told in status.items():
        assert isinstance(ratio, float)
        assert told == ("refused" if ratio > 0.9 else "failed" if ratio > 0.8 else "ok")
    assert set(status.values()) == {"refused", "failed", "ok"}
    assert {trial.reason for trial in found.trials if trial.status == "failed"} == {
        "frame 7: made to fail"
    }


def test_a_policy_that_fails_as_shipped_is_not_tuned(
    made_scored: Made, search: Callable[..., Tuning]
) -> None:
    """There is nothing to be better than."""
    with pytest.raises(PolicyError, match="static-screen, frame 7: made to fail"):
        search(MadeEngine(lambda knob, ratio, path: (math.nan, 0.0), made_scored))


def test_paths_take_part_in_one_set_only(small_scene: Scene) -> None:
    """Training, judging, the next seed's, and a comparison's own paths: no two are the same."""
    sets = [draw_paths("walk", small_scene, paths=3, length_s=2.0, seed=seed) for seed in (0, 1)]
    paths = [path for drawn in sets for path in (*drawn.training, *drawn.judged)]
    paths += load_paths(["walk"], small_scene, paths=3, length_s=2.0)
    assert len({content_hash(path.position_m) for path in paths}) == 15
    of_one = draw_paths("tour", small_scene, paths=3, seconds=(0.0, 3.0), seed=0)
    # The tour stands at first: variations differ in the gaze.
    varied = [content_hash(path.orientation_xyzw) for path in (*of_one.training, *of_one.judged)]
    assert len(set(varied)) == 6


@pytest.mark.slow
def test_the_result_is_the_same_on_any_number_of_workers(
    small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile
) -> None:
    """The record of one worker and that of two have the same bytes."""
    made = tuple(vary(turn_trace, number) for number in range(4))
    records: list[bytes] = []
    for workers in (1, 2):
        found = tune_policy(
            parse_policy("static-screen"),
            ["ratio", "hysteresis"],
            small_scene,
            Paths(made[:2], made[2:]),
            machine,
            ReplayOptions(budget_ms=8.0),
            CompareSettings(workers=workers),
            trials=3,
        )
        records.append(encode_record(found))
    assert records[0] == records[1]


@pytest.mark.parametrize(
    ("policy", "message"),
    [("oracle", "expected a policy, got an oracle"), ("maciel", "name another policy or scene")],
)
def test_policies_that_cannot_be_tuned(
    policy: str,
    message: str,
    small_scene: Scene,
    turn_trace: CameraTrace,
    machine: HardwareProfile,
) -> None:
    """An oracle has no parameters to take home, and what does not fit the scene has no scores."""
    made = tuple(vary(turn_trace, number) for number in range(4))
    with pytest.raises(InputError, match=message):
        tune_policy(
            parse_policy(policy), [], small_scene, Paths(made[:2], made[2:]), machine, REPLAY
        )
