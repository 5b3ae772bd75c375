"""How often the gate fails an unchanged policy, and how often it finds a slower one."""

from dataclasses import replace

import numpy as np
import pytest

from lodbench.analysis.gate.baseline import make_baseline
from lodbench.analysis.gate.check_result import judge_all
from lodbench.analysis.gate.limits_file import DEFAULT_LIMITS, parse_limits
from lodbench.analysis.gate.measurements import Conditions, MeasuredPolicy, MeasureOptions
from lodbench.analysis.gate.measurements import measure as measure_policies
from lodbench.analysis.study.score import World
from lodbench.models.machine.cost import CostModel, CpuCostModel
from lodbench.models.machine.hardware import Display, HardwareProfile, Provenance
from lodbench.models.machine.residual import Residual
from lodbench.models.scene.scene import Scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions
from lodbench.traces.cameras.camera_trace import CameraTrace
from lodbench.traces.cameras.generators.generate import generate

WHOLE, REDUCED = 300, 75  # studies; the first of the whole are the reduced
LIMITS = parse_limits(DEFAULT_LIMITS)
FULL = [parse_policy("full")]


def machine(slower: float) -> HardwareProfile:
    """Build a machine bound by its GPU, with the heavy tails of `desktop-assumed`."""
    return HardwareProfile(
        "machine",
        Provenance("assumed by a test", assumed=True),
        CostModel.of(4.0 * slower, {"triangles": 1e-4 * slower}),
        CpuCostModel.of(2.0, {}),
        Residual("student-t", 0.03, 5.0),
        display=Display("immediate"),
    )


@pytest.fixture(scope="module")
def study_trace() -> CameraTrace:
    """Return a walk among the sixty objects."""
    return generate("walk", duration_s=2.5, extent_m=15.0, center_m=(30.0, 0.0, 0.0), seed=1)


def measure(
    scene: Scene, trace: CameraTrace, seed: int, slower: float
) -> tuple[Conditions, list[MeasuredPolicy]]:
    """Measure one study with the default settings."""
    options = ReplayOptions(budget_ms=16.7, seed=seed)
    return measure_policies(
        FULL, World(scene, trace, machine(slower), options, 0.3), MeasureOptions()
    )


@pytest.mark.slow
@pytest.mark.study
def test_false_alarms_and_regressions_found(
    small_scene: Scene, study_trace: CameraTrace, *, full_studies: bool
) -> None:
    """Of all studies less than 1 % fail when nothing changed, and 95 % when frames take 5 % more.

    Nothing changed means the same seeds, which differ by nothing at all, and also other seeds than
    the baseline's, where the noise is not shared.
    """
    same, other, found = list[bool](), list[bool](), list[bool]()
    step = MeasureOptions().seeds
    before: tuple[Conditions, list[MeasuredPolicy]] | None = None
    for study in range(WHOLE if full_studies else REDUCED):
        conditions, now = measure(small_scene, study_trace, study * step, 1.0)
        baseline = make_baseline(conditions, now, LIMITS)
        same.append(judge_all(LIMITS, now, conditions, baseline, strict=True).passed)
        if before is not None:
            elsewhere = make_baseline(*before, LIMITS)
            other.append(judge_all(LIMITS, now, conditions, elsewhere).passed)
        _, slower = measure(small_scene, study_trace, study * step, 1.05)
        found.append(not judge_all(LIMITS, slower, conditions, baseline).passed)
        before = conditions, now
    print(f"alarms: same seeds {1 - np.mean(same):.3f}, other seeds {1 - np.mean(other):.3f}")
    print(f"regressions of 5 % found: {np.mean(found):.3f}")
    assert all(same)
    assert np.mean(other) > 0.99
    assert np.mean(found) >= 0.95


def test_a_regression_is_found_and_a_rerun_is_not(
    small_scene: Scene, study_trace: CameraTrace
) -> None:
    """One study of the 300, so that the quick tests notice a gate that no longer decides."""
    conditions, now = measure(small_scene, study_trace, 7, 1.0)
    baseline = make_baseline(conditions, now, LIMITS)
    assert judge_all(LIMITS, now, replace(conditions), baseline, strict=True).passed
    _, slower = measure(small_scene, study_trace, 7, 1.05)
    report = judge_all(LIMITS, slower, conditions, baseline)
    assert [(v.metric, v.outcome) for v in report.verdicts] == [
        ("work_ms_p95", "passes"),
        ("work_ms_p99", "fails"),
    ]
    change = report.verdicts[1].change
    assert change is not None
    assert change.value == pytest.approx(5.0, abs=1.0)
