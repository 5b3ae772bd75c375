"""Comparisons of a small world: scores, failures, intervals, pairing, and the same bytes."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
import pytest

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.study.compare import CompareOptions, compare
from lodbench.analysis.study.comparison import Comparison, read_comparison
from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import encode_record
from lodbench.models.machine.cost import CostModel
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.registry import parse_policy, specs_of
from lodbench.sim.frame_log import FrameLog
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

REPLAY = ReplayOptions(budget_ms=8.0, seed=3)
ONE = CompareOptions(workers=1, draws=0, warmup_s=0.5)

MINE = """
import numpy as np
from lodbench.policies import Capabilities, Selection

class Mine:
    capabilities = Capabilities()
    def reset(self, scene, budget_ms): pass
    def select(self, view): return Selection(view.ids, np.full(len(view), {}.0))
"""
UNGUARDED = """
import lodbench
comparison = lodbench.compare(["full", Mine], seconds=(0.0, 1.2), workers=2)
print(*(policy.status for policy in comparison.policies))
"""


class World:
    """The small world, so that a test names only what it is about."""

    def __init__(self, scene: Scene, trace: CameraTrace, machine: HardwareProfile) -> None:
        self.scene, self.trace, self.machine = scene, trace, machine

    def compare(
        self,
        *policies: str,
        options: CompareOptions = ONE,
        replay: ReplayOptions = REPLAY,
        machine: HardwareProfile | None = None,
    ) -> tuple[Comparison, dict[str, FrameLog]]:
        """Compare policies."""
        specs = [parse_policy(text) for text in policies]
        return compare(specs, self.scene, self.trace, machine or self.machine, replay, options)


@pytest.fixture(scope="module")
def world(small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile) -> World:
    """Return the small world."""
    return World(small_scene, turn_trace, machine)


def test_json_follows_the_contract(world: World) -> None:
    """The document has the keys that other tools rely on, in every policy and every metric."""
    comparison, logs = world.compare("full", "static-screen:first=0.5")
    document = msgspec.json.decode(encode_record(comparison))
    assert next(iter(document)) == "schema"
    assert document["schema"] == "lodbench.compare/2"
    wanted = {
        "scene",
        "trace",
        "hardware",
        "budget_ms",
        "seed",
        "window_s",
        "policies",
        "visible_px",
    }
    assert wanted <= set(document)
    assert (document["scene"], document["trace"], document["seed"]) == ("small", "turn", 3)
    second = document["policies"][1]
    assert (second["name"], second["params"]) == ("static-screen", {"first": 0.5})
    assert (second["status"], second["reason"], second["oracle"]) == ("ok", None, False)
    assert set(second["metrics"]) == {metric.id for metric in METRICS}
    for score in second["metrics"].values():
        assert set(score) == {"value", "low", "high", "unit", "better"}
    assert document["window_s"] == [0.5, 3.0]
    assert second["frames"] == len(logs["static-screen:first=0.5"])


def test_absent_metrics_are_null(world: World) -> None:
    """What a run cannot have is null in the JSON, not 0."""
    document = msgspec.json.decode(encode_record(world.compare("full")[0]))
    metrics = document["policies"][0]["metrics"]
    for name in ("prediction_error_pct_mean", "levels_changed_per_s", "optimality"):
        assert metrics[name]["value"] is None
        assert metrics[name]["low"] is None


def test_read_back_equals_what_was_written(world: World, tmp_path: Path) -> None:
    """The JSON of a comparison is the comparison."""
    comparison, _ = world.compare("full", "feedback")
    path = tmp_path / "comparison.json"
    path.write_bytes(encode_record(comparison))
    assert read_comparison(path) == comparison


def test_values_are_those_of_the_log(world: World) -> None:
    """A score is of the frames begun from 0.5 s on, each for as long as the screen waited."""
    comparison, logs = world.compare("static-screen")
    log = logs["static-screen"]
    inside = log["input_ns"] >= 0.5e9
    ends = np.clip(log["display_ns"] * 1e-9, 0.5, 3.0)
    waited = np.diff(ends, prepend=0.5)[inside]
    work = np.maximum(log["cpu_ms"], log["gpu_ms"])[inside]
    metrics = comparison.policies[0].metrics
    mean = (work * waited).sum() / waited.sum()
    assert metrics["work_ms_mean"].value == pytest.approx(mean, rel=1e-9)
    over = waited[work > 8.0].sum() / waited.sum()
    assert metrics["over_budget_time_fraction"].value == pytest.approx(over)
    assert metrics["toggles_per_s"].value == pytest.approx(log["toggles"][inside].sum() / 2.5)


def test_broken_policies_fail_by_name_and_frame(world: World, bad_policies: Path) -> None:
    """Whatever a policy breaks, it fails alone, and the reason names frame and fault."""
    broken = [f"{bad_policies}:{name}" for name in ("Raises", "Nan", "Short", "TooCoarse")]
    comparison, logs = world.compare("full", *broken, "static-screen")
    assert [policy.status for policy in comparison.policies] == ["ok", *["failed"] * 4, "ok"]
    assert list(logs) == ["full", "static-screen"]
    reasons = [str(policy.reason) for policy in comparison.failed]
    assert reasons[0] == "frame 70: ValueError: lost <b>patience</b>"
    first_seen = next(i for i, n in enumerate(logs["full"]["visible"]) if n)
    for reason, fault in zip(reasons[1:], ("nan", "detail: expected", "got 3"), strict=True):
        assert reason.startswith("frame ")
        assert abs(int(reason.split()[1].rstrip(":")) - first_seen) < 400
        assert fault in reason


def test_policy_that_does_not_fit_is_not_applicable(world: World, bad_policies: Path) -> None:
    """A policy for trees is not run on a flat scene, and the reason says why."""
    comparison, _ = world.compare("full", f"{bad_policies}:OnlyTrees")
    assert comparison.policies[1].status == "not-applicable"
    assert "flat" in str(comparison.policies[1].reason)
    assert not comparison.failed


def test_refused_parameters_fail_the_policy_alone(world: World) -> None:
    """Parameters that a policy refuses when it is reset do not stop the others."""
    comparison, _ = world.compare("full", "feedback:target=2")
    assert [policy.status for policy in comparison.policies] == ["ok", "failed"]
    assert "target" in str(comparison.policies[1].reason)


def test_policies_are_named_once(world: World) -> None:
    """Two policies of one label could not be told apart."""
    with pytest.raises(InputError, match="full twice"):
        world.compare("full", "full")


def test_path_that_is_all_warmup_is_refused(world: World) -> None:
    """A warm-up as long as the path leaves nothing to measure, whatever the policy."""
    with pytest.raises(InputError, match="less than the path's 3, got 3"):
        world.compare("full", options=replace(ONE, warmup_s=3.0))


def test_policy_without_a_frame_in_the_window_fails_by_name(world: World) -> None:
    """On a machine that takes two seconds a frame none begins in the last half second."""
    slow = replace(world.machine, gpu=CostModel.of(2_000.0, {}))
    options = replace(ONE, warmup_s=2.5)
    comparison, _ = world.compare("full", options=options, machine=slow)
    (policy,) = comparison.failed
    assert policy.label == "full"
    assert "expected a frame that begins in 2.5 to 3 s" in str(policy.reason)


def test_without_replicates_there_are_no_intervals(world: World) -> None:
    """One seed on one path under one cost model says nothing of any spread."""
    comparison, _ = world.compare("full")
    (step,) = comparison.policies[0].steps
    assert step.time_ms == pytest.approx(1000.0, abs=20.0)
    assert not step.settled
    scores = comparison.policies[0].metrics
    assert scores["overshoot_ratio"].value == pytest.approx(13.0 / 8.0, rel=0.1)
    assert {score.low for score in scores.values()} == {None}


def test_equal_policies_have_equal_scores(world: World) -> None:
    """Common noise: the same policy under two labels has the same scores to the last bit."""
    comparison, _ = world.compare("static-screen", "static-screen:first=0.25")
    first, second = comparison.ok
    assert first.metrics == second.metrics


def test_oracle_is_marked(world: World, bad_policies: Path) -> None:
    """A policy that sees the future is told from those that do not."""
    comparison, _ = world.compare("full", f"{bad_policies}:Seer")
    assert [policy.oracle for policy in comparison.policies] == [False, True]


def test_intervals_are_those_of_the_draws(world: World, fitted_machine: HardwareProfile) -> None:
    """Coefficients known to 20 % leave a 95th percentile known no better; the value is the mean's.

    The slowest frames have all objects in view: 1 ms, and 12 ms times 0.8 to 1.2, with noise.
    """
    with_draws = replace(ONE, draws=6)
    sure, _ = world.compare("full")
    unsure, _ = world.compare("full", options=with_draws, machine=fitted_machine)
    assert (sure.intervals.draws, unsure.intervals.draws) == (0, 6)
    wide, narrow = (c.policies[0].metrics["work_ms_p95"] for c in (unsure, sure))
    assert wide.value == narrow.value
    assert wide.low == pytest.approx(1 + 12 * 0.8, rel=0.08)
    assert wide.high == pytest.approx(1 + 12 * 1.2, rel=0.08)
    for score in unsure.policies[0].metrics.values():
        assert score.low is None or score.high is None or score.low <= score.high


def test_fewer_draws_than_asked_are_each_taken_once(
    world: World, fitted_machine: HardwareProfile
) -> None:
    """A profile with six draws is replayed under six."""
    options = replace(ONE, draws=100)
    comparison, _ = world.compare("full", options=options, machine=fitted_machine)
    assert comparison.intervals.draws == 6


def test_same_bytes_on_any_worker_count(
    world: World, fitted_machine: HardwareProfile, bad_policies: Path
) -> None:
    """One process or two: the same JSON and the same frame logs, failures included."""
    policies = ("full", "feedback", f"{bad_policies}:Raises", f"{bad_policies}:Coarsest")
    results = [
        world.compare(
            *policies,
            options=CompareOptions(workers=workers, draws=2),
            machine=fitted_machine,
        )
        for workers in (1, 2)
    ]
    assert encode_record(results[0][0]) == encode_record(results[1][0])
    for label, log in results[0][1].items():
        other = results[1][1][label]
        assert log.counts.tobytes() == other.counts.tobytes()
        assert log.times_ns.tobytes() == other.times_ns.tobytes()


def test_objects_and_users_classes_reach_workers(world: World, tmp_path: Path) -> None:
    """What is compared need have no name: in two processes it does what it does in one."""
    for folder, level in (("a", "0"), ("b", "1")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "mine.py").write_text(MINE.format(level), encoding="utf-8")
    names = [f"{tmp_path / folder / 'mine.py'}:Mine" for folder in "ab"]
    classes = [parse_policy(name).cls for name in names]
    policies = specs_of({"a": classes[0], "b": classes[1](), "feedback": Feedback(gain=0.5)})
    results = [
        compare(
            policies,
            world.scene,
            world.trace,
            world.machine,
            REPLAY,
            CompareOptions(workers=workers, draws=0),
        )[0]
        for workers in (1, 2)
    ]
    assert results[0] == results[1]
    fine, coarse, _ = (policy.metrics["work_ms_mean"].value for policy in results[0].policies)
    assert fine is not None
    assert coarse is not None
    assert fine > coarse


def test_a_class_of_a_function_reaches_workers(world: World) -> None:
    """A class that no module names is replayed in other processes as one that has a name."""

    class Local(Full):
        pass

    policies = specs_of([Local, "full"])
    options = CompareOptions(workers=2, draws=0)
    comparison, _ = compare(policies, world.scene, world.trace, world.machine, REPLAY, options)
    local, full = comparison.ok
    assert local.metrics == full.metrics


def test_a_script_without_a_guard_runs_once(tmp_path: Path) -> None:
    """Workers never run the script again, and its classes reach them."""
    script = tmp_path / "unguarded.py"
    script.write_text(MINE.format(0) + UNGUARDED, encoding="utf-8")
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300)
    assert (run.stdout, run.stderr, run.returncode) == ("ok ok\n", "", 0)


def test_seed_changes_the_noise(world: World) -> None:
    """Another seed is another day on the same machine."""
    first, again, other = (
        world.compare("full", replay=ReplayOptions(budget_ms=8.0, seed=seed))[0]
        for seed in (0, 0, 1)
    )
    assert first == again
    assert first.policies[0].metrics["work_ms_mean"] != other.policies[0].metrics["work_ms_mean"]


def test_progress_counts_every_replay(world: World, fitted_machine: HardwareProfile) -> None:
    """Two policies under the mean and two draws are six replays."""
    seen: list[tuple[int, int]] = []
    compare(
        [parse_policy("full"), parse_policy("feedback")],
        world.scene,
        world.trace,
        fitted_machine,
        REPLAY,
        CompareOptions(workers=1, draws=2),
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen == [(i, 6) for i in range(1, 7)]


@pytest.mark.parametrize("field", ["draws", "workers"])
def test_options_are_checked(field: str) -> None:
    """A negative count is refused by its name."""
    with pytest.raises(InputError, match=field):
        replace(ONE, **{field: -1})


def test_broken_comparison_file_is_refused(tmp_path: Path) -> None:
    """A missing, empty or foreign file is bad input with a path, not a traceback."""
    path = tmp_path / "comparison.json"
    for content in (None, b"", b"\xff\xfe", b'{"schema": "lodbench.compare/1"}', b"[1, 2]"):
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(InputError, match=r"comparison\.json"):
            read_comparison(path)
