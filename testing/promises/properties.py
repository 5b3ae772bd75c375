"""Promises with the worlds in which hypothesis explores them.

Each is called with what makes a policy, such as its class, and raises with the smallest example
that it finds.  All worlds are without noise, so that what fails is the policy.
"""

from dataclasses import replace

from hypothesis import strategies as st

from ...policies.protocol import Capabilities
from ..examples.example import Example
from ..examples.worlds import moving, resting, stepping
from . import agreement, claims
from .property import Property


def _growing(capabilities: Capabilities, rest: int) -> st.SearchStrategy[tuple[Example, Example]]:
    def grown(example: Example, factor: float) -> tuple[Example, Example]:
        return example, replace(example, budget_ms=factor * example.budget_ms)

    still = resting(capabilities, rest, (1, 1))
    return st.builds(grown, still, st.sampled_from((1.1, 1.5, 2.0, 4.0)))


def _shuffled(capabilities: Capabilities, rest: int) -> st.SearchStrategy[tuple[Example, int]]:
    return st.tuples(moving(capabilities, rest), st.integers(0, 20))


def _twice(capabilities: Capabilities, rest: int) -> st.SearchStrategy[tuple[Example, Example]]:
    return moving(capabilities, rest).map(lambda example: (example, example))


budget_is_kept = Property.of(claims.budget_is_kept, moving)
lag_is_bounded = Property.of(claims.lag_is_bounded, moving)
nothing_toggles_at_rest = Property.of(claims.nothing_toggles_at_rest, resting)
load_steps_settle = Property.of(claims.load_steps_settle, stepping)
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
