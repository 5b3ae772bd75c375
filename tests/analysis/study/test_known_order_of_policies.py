"""On the bundled tour policies stand in the order that theory and practice know."""

import pytest

from lodbench.analysis.study.compare import CompareOptions, compare
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.inputs import load_trace
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions


def toured(budget_ms: float, *policies: str) -> Comparison:
    """Compare policies on the bundled scene, trace and profile."""
    scene = load_scene("plaza")
    return compare(
        [parse_policy(text) for text in policies],
        scene,
        load_trace("tour", scene),
        load_hardware("desktop-assumed"),
        ReplayOptions(budget_ms=budget_ms),
        CompareOptions(workers=1, resamples=20),
    )[0]


def test_feedback_is_steadier_than_static_than_none() -> None:
    """Where the way leads into dense areas, frame times vary least under feedback."""
    comparison = toured(8.0, "feedback", "static-distance", "full")
    spread = [policy.metrics["frame_ms_sd"].value or 0.0 for policy in comparison.ok]
    assert 0.0 < spread[0] < spread[1] < spread[2]
    assert comparison.beats["frame_ms_sd"]["static-distance"][2] == 1.0


def test_feedback_overshoots_a_sudden_step_and_settles() -> None:
    """Feedback learns of the step when its frames are over: it overshoots, then holds the budget.

    Without management every frame after the step is over, several times.
    """
    comparison = toured(6.0, "feedback", "full")
    feedback, full = (policy.steps[0] for policy in comparison.ok)
    assert feedback.time_ms == pytest.approx(full.time_ms, abs=50.0)
    assert feedback.load_after_ms > 5.0 * 6.0
    assert 1.05 < feedback.overshoot_ratio < full.overshoot_ratio
    assert feedback.settled
    assert 0.0 < feedback.settle_ms < 1000.0
    assert not full.settled
    assert full.overshoot_ratio == pytest.approx(full.load_after_ms / 6.0, rel=0.15)
