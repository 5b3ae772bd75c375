"""One pytest test of each policy and property."""

from collections.abc import Iterable
from functools import partial
from typing import Any

import pytest

from ..policies.protocol import claims_of
from .example import Factory
from .properties import PROPERTIES
from .property import Property


def parametrize_with_properties(
    factories: Iterable[Factory],
    *,
    properties: Iterable[Property] = PROPERTIES,
    examples: int = 100,
) -> Any:
    """Return a decorator that makes one test of each policy and property.

    The test takes `policy_factory` and `check_property` and calls
    ``check_property(policy_factory)``.  A property that a policy does not claim is skipped.
    """
    chosen = tuple(properties)
    pairs: list[Any] = []
    for factory in factories:
        policy = factory()
        claims = claims_of(policy)
        for item in chosen:
            skip = pytest.mark.skip(reason=f"the policy does not claim {item.name}")
            pairs.append(
                pytest.param(
                    factory,
                    partial(item, examples=examples),
                    id=f"{type(policy).__name__}-{item.name}",
                    marks=() if item.claimed(claims) else skip,
                )
            )
    return pytest.mark.parametrize(("policy_factory", "check_property"), pairs)
