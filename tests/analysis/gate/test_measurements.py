"""What is measured over seeds, the stored baseline, and what a stored comparison holds."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lodbench.analysis.gate.baseline import make_baseline, read_baseline, write_baseline
from lodbench.analysis.gate.check_result import judge_all
from lodbench.analysis.gate.limits_file import parse_limits
from lodbench.analysis.gate.measurements import MeasuredPolicy, MeasureOptions, measure, measure_run
from lodbench.analysis.metrics.measured_frames import MeasuredFrames
from lodbench.analysis.metrics.metric_registry import METRICS
from lodbench.analysis.study.compare import CompareOptions, compare
from lodbench.analysis.study.comparison_folder import write_results
from lodbench.analysis.study.score import World
from lodbench.base.errors import InputError
from lodbench.base.files.strict_json import encode_record
from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions, replay
from lodbench.traces.cameras.camera_trace import CameraTrace

LIMITS = parse_limits(
    """[limits]
frame_ms_p99 = { max = 12.0, max_increase = "2.5%" }
overshoot_ratio = { max_increase = "5%", floor = 0.05 }
"""
)
SAMPLING = MeasureOptions(seeds=3)
POLICIES = [parse_policy("full"), parse_policy("feedback")]


@pytest.fixture
def world(small_scene: Scene, turn_trace: CameraTrace, machine: HardwareProfile) -> World:
    """Return two seconds in the small scene, with a step in load on the way."""
    options = ReplayOptions(budget_ms=8.0, seed=5)
    return World(small_scene, turn_trace.stretch(0.5, 2.5), machine, options, 0.2)


def test_scores_are_means_over_seeds(world: World) -> None:
    """The value is the mean of what three replays with successive seeds have."""
    _, (first, _) = measure(POLICIES, world, SAMPLING)
    values: list[float] = []
    for seed in (5, 6, 7):
        options = replace(world.options, seed=seed)
        policy = POLICIES[0].make()
        log = replay(policy, world.scene, world.trace, world.hardware, options, name="x")
        run = MeasuredFrames(log, 0.2, 2.0)
        values.append(float(np.nanquantile(run.frame_ms, 0.99)))
    score = first.scores["frame_ms_p99"]
    assert score.value is not None
    assert score.value == pytest.approx(np.mean(values))
    assert [log.header.seed for log in first.logs] == [5, 6, 7]
    assert score.low is not None
    assert score.high is not None
    assert score.low < score.value < score.high


def test_intervals_are_students_over_seeds(world: World) -> None:
    """The overshoot after the only step of the path is judged by how it differs among seeds.

    Of three values the mean is known to 2.92 standard errors; of one nothing is.
    """
    _, (every,) = measure(POLICIES[:1], world, SAMPLING)
    score, values = every.scores["overshoot_ratio"], every.by_seed["overshoot_ratio"]
    known = [value for value in values if value is not None]
    half = 2.91998558 * np.std(known, ddof=1) / np.sqrt(3)
    assert score.low == pytest.approx(np.mean(known) - half)
    assert score.high == pytest.approx(np.mean(known) + half)
    _, (alone,) = measure(POLICIES[:1], world, replace(SAMPLING, seeds=1))
    assert alone.scores["overshoot_ratio"].low is None


def test_verdicts_do_not_depend_on_workers(world: World) -> None:
    """The same bytes come from one process and from two."""
    texts: set[bytes] = set()
    for workers in (1, 2):
        conditions, measured = measure(POLICIES, world, replace(SAMPLING, workers=workers))
        texts.add(encode_record(judge_all(LIMITS, measured, conditions, None)))
    assert len(texts) == 1


def test_draws_of_the_cost_model_widen_intervals(
    world: World, fitted_machine: HardwareProfile
) -> None:
    """With 20 % between draws of the triangle cost the interval is wider than of noise alone."""
    narrow, wide = (
        measure(POLICIES[:1], replace(world, hardware=fitted_machine), replace(SAMPLING, draws=n))[
            1
        ][0].scores["work_ms_p95"]
        for n in (0, 6)
    )
    assert wide.value == narrow.value
    assert wide.high is not None
    assert wide.low is not None
    assert narrow.high is not None
    assert narrow.low is not None
    assert wide.high - wide.low > 2.0 * (narrow.high - narrow.low)


def test_baseline_is_deterministic_and_changes_nothing(world: World, tmp_path: Path) -> None:
    """The file has the same bytes again, and a run is not worse than itself by any amount."""
    conditions, measured = measure(POLICIES, world, SAMPLING)
    baseline = make_baseline(conditions, measured, LIMITS)
    one, two = tmp_path / "one.json", tmp_path / "two.json"
    write_baseline(one, baseline)
    write_baseline(two, make_baseline(*measure(POLICIES, world, SAMPLING), LIMITS))
    assert one.read_bytes() == two.read_bytes()
    assert set(tmp_path.iterdir()) == {one, two}
    none = parse_limits("[limits]\nframe_ms_p99 = { max_increase = '0%', max_decrease = '0%' }")
    stored = read_baseline(one, conditions)
    report = judge_all(none, measured, conditions, stored, strict=True)
    assert [verdict.outcome for verdict in report.verdicts] == ["passes"] * 4


def test_baseline_of_other_conditions_is_refused(world: World, tmp_path: Path) -> None:
    """Other seeds, warm-ups or machines cannot be paired, and the error says which."""
    conditions, measured = measure(POLICIES, world, SAMPLING)
    path = tmp_path / "baseline.json"
    write_baseline(path, make_baseline(conditions, measured, LIMITS))
    for name, value in (("seeds", 4), ("hardware", "other"), ("warmup_s", 0.3)):
        changed = replace(conditions, **{name: value})
        with pytest.raises(InputError, match=f"expected a baseline of {name} {value}, got"):
            read_baseline(path, changed)
    for content in (b"", b"[]", b"\xff\xfe", b'{"conditions": 3}'):
        path.write_bytes(content)
        with pytest.raises(InputError, match="--update-baseline"):
            read_baseline(path, conditions)
    path.unlink()
    with pytest.raises(InputError, match="No such file"):
        read_baseline(path, conditions)


def test_a_stored_comparison_is_measured_as_it_was_scored(world: World, tmp_path: Path) -> None:
    """Scores are those of `compare`, and so are the values of its one seed."""
    comparison, logs = compare(
        POLICIES,
        world.scene,
        world.trace,
        world.hardware,
        world.options,
        CompareOptions(warmup_s=0.2, workers=1),
    )
    write_results(tmp_path / "run", comparison, logs)
    conditions, measured = measure_run(tmp_path / "run")
    assert (conditions.seeds, conditions.seed, conditions.warmup_s) == (1, 5, 0.2)
    for item, policy in zip(measured, comparison.policies, strict=True):
        assert item.scores == policy.metrics
        assert item.by_seed == {name: [one.value] for name, one in policy.metrics.items()}


def test_every_metric_has_a_worst_frame_or_none(world: World) -> None:
    """The worst frame is one of the measured ones, and holds the extreme of its column."""
    conditions, measured = measure(POLICIES, world, SAMPLING)
    text = "\n".join(f"{metric.id} = {{ max = 0 }}" for metric in METRICS)
    report = judge_all(parse_limits(f"[limits]\n{text}"), measured, conditions, None)
    by_name = {(item.policy, log.header.seed): log for item in measured for log in item.logs}
    found = [verdict for verdict in report.verdicts if verdict.worst is not None]
    assert len(found) > len(METRICS) // 2
    for verdict in found:
        worst = verdict.worst
        assert worst is not None
        log = by_name[verdict.policy, worst.seed]
        assert 0.2 <= worst.time_s <= 2.0
        assert worst.time_s == log["input_ns"][worst.frame] * 1e-9
        assert worst.camera_m == tuple(log[axis][worst.frame] for axis in ("x_m", "y_m", "z_m"))
        if verdict.metric == "work_ms_max":
            assert worst.value == verdict_max(measured, verdict.policy)


def verdict_max(measured: list[MeasuredPolicy], policy: str) -> float:
    """Return the largest work time of a policy in all its replays."""
    logs = next(item.logs for item in measured if item.policy == policy)
    return max(float(MeasuredFrames(log, 0.2).work_ms.max()) for log in logs)
