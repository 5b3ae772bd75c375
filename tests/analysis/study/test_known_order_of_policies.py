"""On the bundled tour policies stand in the order that theory and practice know."""

import pytest

from lodbench.analysis.study.compare import CompareSettings, compare
from lodbench.analysis.study.comparison import Comparison
from lodbench.analysis.study.inputs import adjust_machine, load_trace
from lodbench.models.machine.profile_catalog import load_hardware
from lodbench.models.scene.scene_catalog import load_scene
from lodbench.policies.registry import parse_policy
from lodbench.sim.replay import ReplayOptions


@pytest.fixture(scope="module")
def toured() -> Comparison:
    """Compare three policies on the bundled scene and trace at 6 ms, with no wait for a display."""
    scene = load_scene("plaza")
    return compare(
        [parse_policy(text) for text in ("feedback", "static-distance", "full")],
        scene,
        [load_trace("tour", scene)],
        adjust_machine(load_hardware("desktop-assumed"), "immediate", None, None),
        ReplayOptions(budget_ms=6.0),
        CompareSettings(workers=1, as_shipped=True, seeds=1, draws=0),
    ).comparison


def test_managed_frames_are_steadier_than_none(toured: Comparison) -> None:
    """Where the way leads into dense areas, frame times vary most where nothing is managed.

    Feedback uses more of the budget than distances as shipped, so their spreads say nothing of each
    other.
    """
    spread = {policy.label: policy.value_of("frame_ms_sd") or 0.0 for policy in toured.ok}
    work = {policy.label: policy.value_of("work_ms_mean") or 0.0 for policy in toured.ok}
    assert 0.0 < max(spread["feedback"], spread["static-distance"]) < spread["full"] / 2.0
    assert work["static-distance"] < work["feedback"]


def test_feedback_overshoots_a_sudden_step_and_settles(toured: Comparison) -> None:
    """Feedback learns of the step when its frames are over: it overshoots, then holds the budget.

    Without management every frame after the step is over, several times.
    """
    steps = {policy.label: policy.steps[0] for policy in toured.ok}
    feedback, full = steps["feedback"], steps["full"]
    assert feedback.time_ms == pytest.approx(full.time_ms, abs=50.0)
    assert feedback.load_after_ms > 5.0 * 6.0
    assert 1.05 < feedback.overshoot_ratio < full.overshoot_ratio
    assert feedback.settled
    assert 0.0 < feedback.settle_ms < 1000.0
    assert not full.settled
    assert full.overshoot_ratio == pytest.approx(full.load_after_ms / 6.0, rel=0.15)
