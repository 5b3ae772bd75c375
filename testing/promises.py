"""Every promise that policies make; each is called with what makes a policy."""

from . import agreement, claims
from .promise import Promise

CHECKS: tuple[Promise, ...] = (
    agreement.valid_selections,
    agreement.empty_frames,
    agreement.one_object,
    agreement.next_to_no_budget,
    agreement.everything_resident,
    agreement.draws_what_is_resident,
    agreement.two_instances_agree,
    agreement.reset_forgets,
    agreement.leaves_the_view_alone,
    agreement.order_does_not_matter,
    agreement.pickles,
    agreement.parameters_round_trip,
    claims.faulty_timings_never_raise_detail,
    claims.budget_is_kept,
    claims.lag_is_bounded,
    claims.more_budget_is_never_worse,
    claims.nothing_toggles_at_rest,
    claims.load_steps_settle,
    claims.hysteresis_holds,
)
"""All promises, in the order in which they are checked."""
