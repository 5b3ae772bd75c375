"""Runs all checks on policies: as a list of results, or as tests of pytest."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Any
from unittest import SkipTest

from . import corners, promises, repeatable
from .driver import CheckError
from .walks import Factory

Check = Callable[[Factory], None]

CHECKS: tuple[Check, ...] = (
    corners.valid_selections,
    corners.empty_frames,
    corners.one_object,
    corners.next_to_no_budget,
    corners.everything_resident,
    corners.draws_what_is_resident,
    repeatable.two_instances_agree,
    repeatable.reset_forgets,
    repeatable.leaves_the_view_alone,
    repeatable.renumbering_permutes,
    repeatable.pickles,
    repeatable.parameters_round_trip,
    promises.faulty_timings_never_raise_detail,
    promises.keeps_the_budget,
    promises.more_budget_never_lowers_benefit,
    promises.settles,
    promises.hysteresis_holds,
)
"""Every check: takes what makes a policy, raises if it fails, SkipTest if it does not apply."""


@dataclass(frozen=True, slots=True)
class CheckResult:
    """What a check found.

    Attributes
    ----------
    name : str
    passed : bool
        True also of checks that do not apply.
    message : str
        What is wrong; empty if nothing is.
    skipped : str or None
        Why the check does not apply, such as a property that the policy does not claim.
    """

    name: str
    passed: bool
    message: str = ""
    skipped: str | None = None


def check_policy(factory: Factory) -> list[CheckResult]:
    """Run every check on the policies that a class, or a function without arguments, makes."""
    return [_result(check, factory) for check in CHECKS]


def _result(check: Check, factory: Factory) -> CheckResult:
    name = check.__name__
    try:
        check(factory)
    except SkipTest as reason:
        return CheckResult(name, passed=True, skipped=str(reason))
    except CheckError as error:
        return CheckResult(name, passed=False, message=str(error))
    except Exception as error:  # noqa: BLE001 - a user's class may raise anything when it is made
        return CheckResult(name, passed=False, message=f"{type(error).__name__}: {error}")
    return CheckResult(name, passed=True)


def parametrize_with_checks(factories: Iterable[Factory]) -> Any:
    """Return a decorator that makes one test of each policy and check.

    The test takes `policy_factory` and `check` and calls ``check(policy_factory)``; checks that do
    not apply are skipped with their reason.
    """
    import pytest

    pairs = [
        pytest.param(factory, check, id=f"{_name(factory)}-{check.__name__}")
        for factory in factories
        for check in CHECKS
    ]
    return pytest.mark.parametrize(("policy_factory", "check"), pairs)


def _name(factory: Factory) -> str:
    """Return what a test is called after: the class, and the arguments bound to it."""
    if isinstance(factory, partial):
        given = ",".join(f"{key}={value}" for key, value in factory.keywords.items())
        return f"{_name(factory.func)}({given})"
    return str(getattr(factory, "__name__", factory))
