"""The contract: every registered policy against every check, and some with other parameters."""

from functools import partial
from typing import Any

import pytest

from lodbench.policies.registry import REGISTERED, parse_policy
from lodbench.testing import parametrize_with_checks

Factory = Any
Check = Any

ELSEWHERE = {
    "static-distance:hysteresis=0.1",
    "pixel-error:hysteresis=0.2",
    "gobbetti:engine=newton,m=2",
    "peng:mode=water-filled,threshold_px=500",
    "funkhouser:mode=greedy",
    "funkhouser:mode=incremental",
    "lodmanager:active=8",
}
"""Other parameters that change what a policy claims, or how it works."""

SLOW = {
    "funkhouser:adapt=0.5",
    "funkhouser:skip=on,misfit=skip",
    "gobbetti:adapt=0.5",
    "gobbetti:ahead=0.2",
    "gobbetti:hysteresis=0.2,engine=newton",
    "hoppe:rest=off",
    "hoppe:triangles=5000",
    "lodmanager:sharing=off",
    "maciel:threshold=0",
    "oracle:exact_up_to=0",
    "pid:ki=0.5,kd=0.1",
    "predictive:policy=maciel",
    "predictive:policy=static-screen",
    "screen-space-error:memory_bytes=20000",
    "unreal-dynamic:apply=render-scale",
    "wimmer:m=2",
    "zach:engine=newton",
    "zach:splitting=off",
}


def made(names: Any) -> list[Factory]:
    """Return classes, with parameters bound to them where a name has some."""
    specs = [parse_policy(name) for name in sorted(names)]
    return [partial(spec.cls, **spec.params) if spec.params else spec.cls for spec in specs]


@parametrize_with_checks(made(REGISTERED))
def test_registered(policy_factory: Factory, check: Check) -> None:
    """What is registered keeps the contract, and what it claims, with its defaults."""
    check(policy_factory)


@pytest.mark.slow
@parametrize_with_checks(made(ELSEWHERE))
def test_other_parameters(policy_factory: Factory, check: Check) -> None:
    """So it does with parameters on which its claims or its way of working depend."""
    check(policy_factory)


@pytest.mark.slow
@parametrize_with_checks(made(SLOW))
def test_more_parameters(policy_factory: Factory, check: Check) -> None:
    """And with others."""
    check(policy_factory)
