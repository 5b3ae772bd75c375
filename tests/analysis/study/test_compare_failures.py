"""Policies that a comparison cannot score: each fails by name, and the others have their scores."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from lodbench.analysis.study.compare import CompareSettings
from lodbench.base.errors import InputError
from lodbench.models.machine.cost import CostModel
from lodbench.sim.replay import ReplayOptions

REPLAY = ReplayOptions(budget_ms=8.0, seed=3)
ONE = CompareSettings(workers=1, draws=0, warmup_s=0.5, seeds=1)
SHORT = CompareSettings(workers=1, draws=0, warmup_s=0.1)


def test_broken_policies_fail_by_name_and_frame(world: Any, bad_policies: Path) -> None:
    """Whatever a policy breaks, it fails alone, and the reason names frame and fault."""
    broken = [f"{bad_policies}:{name}" for name in ("Raises", "Nan", "Short", "TooCoarse")]
    compared = world.compare("full", *broken, "static-screen:bias=1")
    comparison, logs = compared.comparison, compared.logs
    assert [policy.label for policy in comparison.failed] == broken
    assert sorted(policy.label for policy in comparison.ok) == ["full", "static-screen:bias=1"]
    assert set(logs) == {"full", "static-screen:bias=1"}
    reasons = [str(policy.reason) for policy in comparison.failed]
    assert reasons[0] == "frame 70: ValueError: lost <b>patience</b>"
    first_seen = next(i for i, n in enumerate(logs["full"]["visible"]) if n)
    for reason, fault in zip(reasons[1:], ("nan", "detail: expected", "got 3"), strict=True):
        assert reason.startswith("frame ")
        assert abs(int(reason.split()[1].rstrip(":")) - first_seen) < 400
        assert fault in reason


REFUSES = """
from lodbench import InputError
from lodbench.policies import Capabilities

class Refuses:
    capabilities = Capabilities()
    def reset(self, scene, budget_ms): raise InputError("weights.npz: expected numbers, got none")
    def select(self, view): raise NotImplementedError
"""


def test_what_a_policy_refuses_when_it_begins_is_its_own_failure(
    world: Any, tmp_path: Path
) -> None:
    """An input error of a user's class ends no study: the others are scored."""
    own = tmp_path / "mine.py"
    own.write_text(REFUSES, encoding="utf-8")
    comparison = world.compare("full", f"{own}:Refuses").comparison
    assert [policy.label for policy in comparison.ok] == ["full"]
    (failed,) = comparison.failed
    assert failed.reason is not None
    assert failed.reason.startswith("reset: ")
    assert "weights.npz: expected numbers, got none" in failed.reason


def test_policy_that_does_not_fit_is_not_applicable(world: Any, bad_policies: Path) -> None:
    """A policy for trees is not run on a flat scene, and the reason says why."""
    comparison = world.compare("full", f"{bad_policies}:OnlyTrees").comparison
    assert comparison.policies[1].status == "not-applicable"
    assert "flat" in str(comparison.policies[1].reason)
    assert not comparison.failed


def test_refused_parameters_are_told_before_any_run(world: Any) -> None:
    """Parameters out of their range are bad input, and nobody is replayed for them."""
    with pytest.raises(InputError, match=r"expected target in \(0, 1\], got 2"):
        world.compare("full", "feedback:target=2")


def test_policies_are_named_once(world: Any) -> None:
    """Two policies of one label could not be told apart."""
    with pytest.raises(InputError, match="full twice"):
        world.compare("full", "full")


def test_path_that_is_all_warmup_is_refused(world: Any) -> None:
    """A warm-up as long as the path leaves nothing to measure, whatever the policy."""
    with pytest.raises(InputError, match="less than the path's 3, got 3"):
        world.compare("full", settings=replace(ONE, warmup_s=3.0))


def test_policy_without_a_frame_in_the_window_fails_by_name(world: Any) -> None:
    """On a machine that takes two seconds a frame none begins in the last half second."""
    slow = replace(world.machine, gpu=CostModel.of(2_000.0, {}))
    settings = replace(ONE, warmup_s=2.5)
    comparison = world.compare("full", settings=settings, machine=slow).comparison
    (policy,) = comparison.failed
    assert policy.label == "full"
    assert "expected a frame that begins in 2.5 to 3 s" in str(policy.reason)
