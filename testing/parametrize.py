"""One pytest test of each policy and each promise that applies to it."""

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

import pytest

from .contract import CHECKS
from .examples.example import Factory
from .promises.promise import Promise

if TYPE_CHECKING:  # needs hypothesis, which checks do without
    from .promises.property import Property

Kind = TypeVar("Kind", bound=Promise)


def parametrize_with_checks(factories: Iterable[Factory]) -> Any:
    """Return a decorator that makes one test of each policy and check.

    The test takes `policy_factory` and `check` and calls ``check(policy_factory)``; there is no
    test of a check that does not apply.
    """
    pairs = [
        pytest.param(factory, check, id=f"{_name(factory)}-{check.name}")
        for factory in factories
        for check in _applying(factory, CHECKS)
    ]
    return pytest.mark.parametrize(("policy_factory", "check"), pairs)


def parametrize_with_properties(
    factories: Iterable[Factory],
    *,
    properties: "Iterable[Property] | None" = None,
    examples: int = 100,
) -> Any:
    """Return a decorator that makes one test of each policy and property, all by default.

    The test takes `policy_factory` and `check_property` and calls
    ``check_property(policy_factory)``; there is no test of what a policy does not claim.
    """
    from .promises.properties import PROPERTIES

    chosen = PROPERTIES if properties is None else tuple(properties)
    pairs = [
        pytest.param(factory, partial(item, examples=examples), id=f"{_name(factory)}-{item.name}")
        for factory in factories
        for item in _applying(factory, chosen)
    ]
    return pytest.mark.parametrize(("policy_factory", "check_property"), pairs)


def _applying(factory: Factory, promises: Iterable[Kind]) -> Iterable[Kind]:
    """Return the promises that apply; all if no policy can be made, so that the tests say why."""
    try:
        policy = factory()
    except Exception:  # noqa: BLE001 - a user's class may raise anything when it is made
        return promises
    return [promise for promise in promises if promise.why_not(policy) is None]


def _name(factory: Factory) -> str:
    """Return what a test is called after: the class, and the arguments bound to it."""
    if isinstance(factory, partial):
        given = ",".join(f"{key}={value}" for key, value in factory.keywords.items())
        return f"{_name(factory.func)}({given})"
    return str(getattr(factory, "__name__", factory))
