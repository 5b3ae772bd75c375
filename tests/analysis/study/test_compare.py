"""Comparisons of a small world: scores, failures, intervals, pairing, and the same bytes."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison import read_comparison
from lodbench.analysis.study.comparison_folder import write_results
from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import encode_record
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.policies.bounds.full import Full
from lodbench.policies.controllers.feedback import Feedback
from lodbench.policies.registry import parse_policy, specs_of
from lodbench.sim.replay import ReplayOptions

REPLAY = ReplayOptions(budget_ms=8.0, seed=3)
ONE = CompareSettings(workers=1, draws=0, warmup_s=0.5, seeds=1)
SHORT = CompareSettings(workers=1, draws=0, warmup_s=0.1)

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
comparison = lodbench.compare(
    ["full", Mine], scene="plaza", traces="walk", paths=2, seconds=(0.0, 1.2), workers=2
)
print(*(policy.status for policy in comparison.policies))
"""


def test_json_follows_the_contract(world: Any) -> None:
    """The document has the keys that other tools rely on, in every policy and every metric."""
    document = msgspec.json.decode(
        encode_record(world.compare("full", "static-screen:first=0.5").comparison)
    )
    assert next(iter(document)) == "schema"
    assert document["schema"] == "lodbench.compare/2"
    wanted = {
        *("scene", "paths", "hardware", "budget_ms", "miss", "seed", "window_s", "population"),
        *("answer", "policies", "p_best", "regret", "least_miss", "curve", "margin", "visible"),
        *("worst_moments", "robustness", "provenance"),
    }
    assert wanted <= set(document)
    assert (document["scene"], document["paths"], document["seed"]) == ("small", ["turn"], 3)
    second = next(policy for policy in document["policies"] if policy["params"])
    assert (second["name"], second["params"]) == ("static-screen", {"first": 0.5})
    assert second["label"] == "static-screen:first=0.5"
    assert (second["status"], second["reason"], second["oracle"]) == ("ok", None, False)
    knob = second["knob"]
    assert (knob["name"], knob["value"], knob["tuned"]) == ("bias", 1.0, False)
    assert {"rank", "same_as"} <= set(second)
    assert "probability" in second["keeps_budget"]
    assert set(second["metrics"]) == {metric.id for metric in METRICS}
    for score in second["metrics"].values():
        assert {"value", "this_path", "such_paths", "unit", "better"} <= set(score)
    assert document["window_s"] == [[0.5, 3.0]]
    assert document["population"] == "this path"
    assert len(document["answer"]) == 3
    assert document["worst_moments"].keys() == {"full", "static-screen:first=0.5"}
    assert {"command", "version", "hashes"} <= set(document["provenance"])
    assert document["provenance"]["hashes"].keys() == {
        *("scene small", "hardware machine", "path turn")
    }


def test_absent_metrics_are_null(world: Any) -> None:
    """What a run cannot have is null in the JSON, not 0."""
    document = msgspec.json.decode(encode_record(world.compare("full").comparison))
    metrics = document["policies"][0]["metrics"]
    for name in ("prediction_error_pct_mean", "levels_changed_per_s", "optimality"):
        assert metrics[name]["value"] is None
        assert metrics[name]["this_path"] is None


def test_read_back_equals_what_was_written(world: Any, tmp_path: Path) -> None:
    """The JSON of a comparison is the comparison."""
    comparison = world.compare("full", "feedback:target=0.9").comparison
    path = tmp_path / "comparison.json"
    path.write_bytes(encode_record(comparison))
    assert read_comparison(path) == comparison


def test_values_are_those_of_the_log(world: Any) -> None:
    """A score is of the frames begun from 0.5 s on, each for as long as the screen waited."""
    compared = world.compare("static-screen:bias=1")
    log = compared.logs["static-screen:bias=1"]
    inside = log["input_ns"] >= 0.5e9
    ends = np.clip(log["display_ns"] * 1e-9, 0.5, 3.0)
    waited = np.diff(ends, prepend=0.5)[inside]
    work = np.maximum(log["cpu_ms"], log["gpu_ms"])[inside]
    metrics = compared.comparison.policies[0].metrics
    mean = (work * waited).sum() / waited.sum()
    assert metrics["work_ms_mean"].value == pytest.approx(mean, rel=1e-9)
    over = waited[work > 8.0].sum() / waited.sum()
    assert metrics["over_budget_time_fraction"].value == pytest.approx(over)
    assert metrics["toggles_per_s"].value == pytest.approx(log["toggles"][inside].sum() / 2.5)


def test_the_hash_of_settings_tells_what_was_asked(world: Any) -> None:
    """Another margin, budget, share or warm-up is another question; other policies are not."""

    def settings(*policies: str, budget_ms: float = 8.0, **changed: float) -> str:
        replay = replace(REPLAY, budget_ms=budget_ms)
        found = world.compare(*policies, settings=replace(ONE, **changed), replay=replay)
        return found.comparison.provenance.settings

    same = settings("full")
    assert same == settings("static-screen:bias=1")
    others = [settings("full", budget_ms=9.0), settings("full", margin=0.2)]
    others += [settings("full", miss=0.02), settings("full", warmup_s=0.6)]
    assert len({same, *others}) == 5


def test_without_replicates_there_are_no_intervals(world: Any) -> None:
    """One seed on one path under one cost model says nothing of any spread, nor how sure it is."""
    comparison = world.compare("full").comparison
    (step,) = comparison.policies[0].steps
    assert step.time_ms == pytest.approx(1000.0, abs=20.0)
    assert not step.settled
    scores = comparison.policies[0].metrics
    assert scores["overshoot_ratio"].value == pytest.approx(13.0 / 8.0, rel=0.1)
    spans = [(score.this_path, score.such_paths, score.with_machine) for score in scores.values()]
    assert set(spans) == {(None, None, None)}
    keeps = comparison.policies[0].keeps_budget
    assert keeps is not None
    assert (keeps.probability, keeps.kept, keeps.paths) == (None, 0, 1)
    assert comparison.p_best == {}


def test_seeds_are_replays_of_each_path_under_other_noise(world: Any) -> None:
    """Each seed is a row on each path; two or more give an interval, of this path alone."""
    compared = world.compare("full", settings=replace(ONE, seeds=3))
    assert compared.comparison.sampling.seeds == 3
    assert compared.runs is not None
    assert set(compared.runs["seed"].to_pylist()) == {3, 4, 5}
    assert len(compared.runs) == 3
    score = compared.comparison.policies[0].metrics["work_ms_mean"]
    assert score.this_path is not None
    assert score.value is not None
    assert score.this_path[0] < score.value < score.this_path[1]
    assert score.such_paths is None
    assert world.compare("full", settings=replace(ONE, seeds=None)).comparison.sampling.seeds == 5
    two = world.compare("full", settings=SHORT, paths=world.short_paths(2)).comparison
    assert two.sampling.seeds == 2


def test_equal_policies_are_folded(world: Any) -> None:
    """Common noise: the same policy under two labels has the same scores to the last bit."""
    comparison = world.compare("static-screen:bias=1", "static-screen:first=0.25").comparison
    first, second = comparison.ok
    assert first.metrics == second.metrics
    assert (first.same_as, second.same_as) == (None, first.label)
    assert second.label not in "".join(comparison.answer)


def test_oracle_is_marked(world: Any, bad_policies: Path) -> None:
    """A policy that sees the future is told from those that do not, and has no rank."""
    comparison = world.compare("full", f"{bad_policies}:Seer").comparison
    assert [(policy.oracle, policy.rank) for policy in comparison.policies] == [
        *((False, None), (True, None))
    ]


def test_same_bytes_on_any_worker_count(
    world: Any, fitted_machine: HardwareProfile, bad_policies: Path, tmp_path: Path
) -> None:
    """One process or two: the same folder to the byte, tuning and failures included."""
    policies = ("full", "static-screen", f"{bad_policies}:Raises", f"{bad_policies}:Coarsest")
    for workers in (1, 2):
        compared = world.compare(
            *policies,
            settings=replace(SHORT, workers=workers, draws=2),
            machine=fitted_machine,
            paths=world.short_paths(2),
        )
        write_results(tmp_path / str(workers), compared)
    files = [path for path in (tmp_path / "1").rglob("*") if path.is_file()]
    assert {path.name for path in files} >= {"comparison.json", "runs.parquet", "full.parquet"}
    for path in files:
        twin = tmp_path / "2" / path.relative_to(tmp_path / "1")
        assert path.read_bytes() == twin.read_bytes(), path.name


def test_objects_and_users_classes_reach_workers(world: Any, tmp_path: Path) -> None:
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
            [world.trace],
            world.machine,
            REPLAY,
            replace(ONE, workers=workers),
        ).comparison
        for workers in (1, 2)
    ]
    assert results[0] == results[1]
    work = {item.label: item.value_of("work_ms_mean") for item in results[0].policies}
    fine, coarse = work["a"], work["b"]
    assert fine is not None
    assert coarse is not None
    assert fine > coarse


def test_a_class_of_a_function_reaches_workers(world: Any) -> None:
    """A class that no module names is replayed in other processes as one that has a name."""

    class Local(Full):
        pass

    policies = specs_of([Local, "full"])
    settings = replace(ONE, workers=2)
    comparison = compare(
        policies, world.scene, [world.trace], world.machine, REPLAY, settings
    ).comparison
    local, full = comparison.ok
    assert local.metrics == full.metrics


def test_a_script_without_a_guard_runs_once(tmp_path: Path) -> None:
    """Workers never run the script again, and its classes reach them."""
    script = tmp_path / "unguarded.py"
    script.write_text(MINE.format(0) + UNGUARDED, encoding="utf-8")
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, timeout=300)
    assert (run.stdout, run.stderr, run.returncode) == ("ok ok\n", "", 0)


def test_seed_changes_the_noise(world: Any) -> None:
    """Another seed is another day on the same machine."""
    first, again, other = (
        world.compare("full", replay=ReplayOptions(budget_ms=8.0, seed=seed)).comparison
        for seed in (0, 0, 1)
    )
    assert first == again
    assert first.policies[0].metrics["work_ms_mean"] != other.policies[0].metrics["work_ms_mean"]


def test_progress_counts_every_replay(world: Any, fitted_machine: HardwareProfile) -> None:
    """Two policies on a path under the mean, two draws, and once for the log: eight replays.

    A round adds what it asks for: the first is of those that are not tuned.
    """
    seen: list[tuple[int, int]] = []
    compare(
        [parse_policy("full"), parse_policy("feedback:target=0.9")],
        world.scene,
        [world.trace],
        fitted_machine,
        REPLAY,
        replace(ONE, draws=2),
        progress=lambda done, total: seen.append((done, total)),
    )
    assert seen == [(1, 2), (2, 2), *((i, 8) for i in range(3, 9))]


@pytest.mark.parametrize(
    ("field", "value"),
    [("draws", -1), ("workers", -1), ("seeds", 0), ("miss", 0.6), ("margin", float("nan"))],
)
def test_settings_are_checked(field: str, value: float) -> None:
    """A number out of range is refused by its name."""
    with pytest.raises(InputError, match=field):
        replace(ONE, **{field: value})


@pytest.mark.parametrize("count", [0, 2])
def test_paths_are_one_or_more_each_with_its_name(world: Any, count: int) -> None:
    """No path at all, and two of one name, are refused before any replay."""
    with pytest.raises(InputError, match="got none" if count == 0 else "got turn twice"):
        compare(
            [parse_policy("full")],
            world.scene,
            [world.trace] * count,
            world.machine,
            REPLAY,
            ONE,
        )


def test_broken_comparison_file_is_refused(tmp_path: Path) -> None:
    """A missing, empty or foreign file is bad input with a path, not a traceback."""
    path = tmp_path / "comparison.json"
    for content in (None, b"", b"\xff\xfe", b'{"schema": "lodbench.compare/1"}', b"[1, 2]"):
        if content is not None:
            path.write_bytes(content)
        with pytest.raises(InputError, match=r"comparison\.json"):
            read_comparison(path)
