"""Checks all promises of a policy, as a list of results; needs neither pytest nor hypothesis."""

from dataclasses import dataclass
from unittest import SkipTest

from ..base.foreign_text import describe_error
from .examples.example import Factory
from .promises import agreement, claims
from .promises.promise import CheckError, Promise, locate

CHECKS = tuple(
    value
    for module in (agreement, claims)
    for value in vars(module).values()
    if isinstance(value, Promise)
)
"""All promises, in the order in which they are checked."""


@dataclass(frozen=True, slots=True)
class CheckResult:
    """What a check showed.

    Attributes
    ----------
    name : str
    passed : bool
        True also of checks that do not apply.
    message : str
        What is wrong, after the file and line of the policy; empty if nothing is.
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


def _result(check: Promise, factory: Factory) -> CheckResult:
    try:
        check(factory)
    except SkipTest as reason:
        return CheckResult(check.name, passed=True, skipped=str(reason))
    except CheckError as error:
        return CheckResult(check.name, passed=False, message=str(error))
    except Exception as error:  # noqa: BLE001 - a user's class may raise anything when it is made
        message = f"{locate(factory, error)}: {describe_error(error)}"
        return CheckResult(check.name, passed=False, message=message)
    return CheckResult(check.name, passed=True)
