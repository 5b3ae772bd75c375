"""Promises with the worlds in which hypothesis explores them.

Each is called with what makes a policy, such as its class, and raises with the smallest example
that it finds.  All worlds are without noise, so that what fails is the policy.
"""

from dataclasses import replace

from hypothesis import strategies as st

from ..policies.protocol import Capabilities
from . import agreement, claims
from .example import Example
from .property import Property
from .worlds import load_steps, still_worlds, worlds


def _moving(capabilities: Capabilities, _rest: int) -> st.SearchStrategy[Example]:
    return worlds(capabilities)


def _resting(capabilities: Capabilities, rest: int) -> st.SearchStrategy[Example]:
    return still_worlds(capabilities, st.integers(rest + 2, rest + 6))


def _stepping(capabilities: Capabilities, rest: int) -> st.SearchStrategy[Example]:
    return load_steps(capabilities, st.integers(rest + 3, rest + 6))


def _growing(capabilities: Capabilities, rest: int) -> st.SearchStrategy[tuple[Example, Example]]:
    def grown(example: Example, factor: float) -> tuple[Example, Example]:
        return example, replace(example, budget_ms=factor * example.budget_ms)

    worlds = still_worlds(capabilities, st.just(rest + 1))
    return st.builds(grown, worlds, st.sampled_from((1.1, 1.5, 2.0, 4.0)))


def _shuffled(capabilities: Capabilities, _rest: int) -> st.SearchStrategy[tuple[Example, int]]:
    return st.tuples(worlds(capabilities), st.integers(0, 20))


def _twice(capabilities: Capabilities, _rest: int) -> st.SearchStrategy[tuple[Example, Example]]:
    return worlds(capabilities).map(lambda example: (example, example))


budget_is_kept = Property.of(claims.budget_is_kept, _moving)
lag_is_bounded = Property.of(claims.lag_is_bounded, _moving)
nothing_toggles_at_rest = Property.of(claims.nothing_toggles_at_rest, _resting)
load_steps_settle = Property.of(claims.load_steps_settle, _stepping)
more_budget_is_never_worse = Property.of(claims.more_budget_is_never_worse, _growing)
order_does_not_matter = Property.of(agreement.order_does_not_matter, _shuffled)
reset_forgets = Property.of(agreement.reset_forgets, _twice)

PROPERTIES = (
    budget_is_kept,
    lag_is_bounded,
    nothing_toggles_at_rest,
    load_steps_settle,
    more_budget_is_never_worse,
    order_does_not_matter,
    reset_forgets,
)
"""All properties, in the order in which tests run them."""
