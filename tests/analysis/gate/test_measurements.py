"""What is measured on paths and under seeds, the baseline of it, and what a comparison holds."""

from dataclasses import replace
from pathlib import Path

import pytest

from lodbench.analysis.gate.baseline import make_baseline, read_baseline, write_baseline
from lodbench.analysis.gate.check_result import judge_all
from lodbench.analysis.gate.limits_file import parse_limits
from lodbench.analysis.gate.measurements import (
    Conditions,
    MeasuredPolicy,
    MeasureOptions,
    measure,
)
from lodbench.analysis.gate.stored_run import measure_run
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison_folder import write_results
from lodbench.analysis.study.replays import noise_seed
from lodbench.analysis.study.score import World, score
from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import encode_record
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace

LIMITS = parse_limits(
    """population = "this-path"
[limits]
work_ms_p99 = { max = 12.0, max_increase = "2.5%" }
overshoot_ratio = { max_increase = "5%", floor = 0.05 }
"""
)
SAMPLING = MeasureOptions(seeds=3)
POLICIES = [parse_policy("full"), parse_policy("feedback")]
OPTIONS = ReplayOptions(budget_ms=8.0, seed=5)
WARMUP_S = 0.3
Measurement = tuple[Conditions, list[MeasuredPolicy]]


@pytest.fixture
def paths(turn_trace: CameraTrace) -> list[CameraTrace]:
    """Return two stretches of a path, with a step in load on the way."""
    whole = turn_trace.duration_s
    return [
        replace(turn_trace.stretch(0.0, whole), name="whole"),
        replace(turn_trace.stretch(0.0, 0.8 * whole), name="most"),
    ]


@pytest.fixture
def measured(small_scene: Scene, paths: list[CameraTrace], machine: HardwareProfile) -> Measurement:
    """Return both policies on both paths under three seeds."""
    return measure(POLICIES, small_scene, paths, machine, OPTIONS, SAMPLING, WARMUP_S)


def test_values_are_by_path_and_seed(
    measured: Measurement,
    small_scene: Scene,
    paths: list[CameraTrace],
    machine: HardwareProfile,
) -> None:
    """Each is what a replay of that path under that noise has, and no two share their noise."""
    _, (full, _) = measured
    values = full.values("work_ms_p99")
    assert values.shape == (2, 3)
    assert full.paths == ("whole", "most")
    for path, seed in ((0, 2), (1, 0)):
        options = replace(OPTIONS, seed=noise_seed(5 + seed, path))
        world = World(small_scene, paths[path], machine, options, WARMUP_S)
        scored = score(world, POLICIES[0], keeps_log=False, beat=lambda _: None)
        assert values[path, seed] == scored.values["work_ms_p99"]
    assert len(set(values.ravel().tolist())) == 6


def test_verdicts_do_not_depend_on_workers(
    measured: Measurement,
    small_scene: Scene,
    paths: list[CameraTrace],
    machine: HardwareProfile,
) -> None:
    """The same bytes come from one process and from two."""
    two = replace(SAMPLING, workers=2)
    again = measure(POLICIES, small_scene, paths, machine, OPTIONS, two, WARMUP_S)
    texts = {
        encode_record(judge_all(LIMITS, policies, conditions, None))
        for conditions, policies in (measured, again)
    }
    assert len(texts) == 1


def test_a_baseline_comes_back_and_changes_nothing(measured: Measurement, tmp_path: Path) -> None:
    """It holds values by path and seed, and a run is not worse than itself by any amount."""
    conditions, policies = measured
    path = tmp_path / "deep" / "baseline.json"
    baseline = make_baseline(conditions, policies, LIMITS)
    write_baseline(path, baseline)
    stored = read_baseline(path, conditions)
    assert stored == baseline
    assert [case.policy for case in stored.cases] == ["feedback", "full"]
    entry = stored.cases[1].paths[0]
    assert entry.path == "whole"
    assert entry.metrics["work_ms_p99"] == policies[0].values("work_ms_p99")[0].tolist()
    none = parse_limits(
        "population = 'this-path'\n[limits]\n"
        "work_ms_p99 = { max_increase = '0%', max_decrease = '0%' }"
    )
    report = judge_all(none, policies, conditions, stored, strict=True)
    assert [verdict.outcome for verdict in report.verdicts] == ["passes"] * 4


def test_baseline_of_other_conditions_is_refused(measured: Measurement, tmp_path: Path) -> None:
    """Other seeds, displays or machines cannot be paired, and the error says which."""
    conditions, policies = measured
    path = tmp_path / "baseline.json"
    write_baseline(path, make_baseline(conditions, policies, LIMITS))
    for name, value in (("seeds", 4), ("hardware", "other"), ("display", "vrr"), ("seed", 6)):
        changed = replace(conditions, **{name: value})
        with pytest.raises(InputError, match=f"expected a baseline of {name} {value}, got"):
            read_baseline(path, changed)
    short = path.read_bytes().replace(b'"seeds": 3', b'"seeds": 2')
    path.write_bytes(short)
    with pytest.raises(InputError, match="expected 2 values of overshoot_ratio on whole"):
        read_baseline(path, replace(conditions, seeds=2))
    for content in (b"", b"[]", b"\xff\xfe", b'{"conditions": 3}'):
        path.write_bytes(content)
        with pytest.raises(InputError, match="--update-baseline"):
            read_baseline(path, conditions)


def test_a_stored_comparison_is_judged_by_its_own_runs(
    small_scene: Scene, paths: list[CameraTrace], machine: HardwareProfile, tmp_path: Path
) -> None:
    """Its judged runs, tuned or as typed, are the measurement; replays of tuning are not."""
    specs = [parse_policy("full"), parse_policy("static-screen"), parse_policy("feedback:gain=0.4")]
    settings = CompareSettings(workers=1, warmup_s=WARMUP_S, draws=0)
    compared = compare(specs, small_scene, paths, machine, OPTIONS, settings)
    write_results(tmp_path / "run", compared)
    conditions, policies = measure_run(tmp_path / "run")
    assert (conditions.seeds, conditions.seed, conditions.warmup_s) == (2, 5, WARMUP_S)
    assert {item.policy for item in policies} == {spec.label for spec in specs}
    for item, policy in zip(policies, compared.comparison.policies, strict=True):
        assert item.paths == ("whole", "most")
        for metric in METRICS:
            value = policy.metrics[metric.id].value
            if value is not None and metric.id == "work_ms_mean":
                assert item.values(metric.id).mean() == pytest.approx(value)
    typed = [spec for spec in specs if spec.label != "static-screen"]
    _, own = measure(
        typed, small_scene, paths, machine, OPTIONS, replace(SAMPLING, seeds=2), WARMUP_S
    )
    stored = {item.policy: item for item in policies}
    for item in own:
        assert item.hashes == stored[item.policy].hashes
        assert (item.values("work_ms_p99") == stored[item.policy].values("work_ms_p99")).all()
