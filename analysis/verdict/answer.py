"""The answer in three sentences, made from the same record as the table.

The first says whom to take, the second how sure that is, the third who cannot keep the budget.
"""

from collections.abc import Sequence

from ..study.comparison_parts import Chances, LeastMiss, PolicyResult, Robustness, knob_text

SEEN = ("visible_error_px", "visible_pops_per_s")
"""Metrics of what can be seen where everything is drawn."""

ORDER = ("missing_objects_mean", *SEEN, "lag_ms_mean", "work_ms_mean")
"""Metrics of the ranking, the first of most weight: a hole in the picture is a fault before all."""

_NOTHING_PX, _NOTHING_POPS, _NOTHING_MISSING = 0.005, 0.05, 0.005
"""Less than tables show: nothing that can be seen."""


def answer(
    policies: Sequence[PolicyResult],
    budget_ms: float,
    order: Chances,
    least_miss: LeastMiss | None,
    robustness: Robustness | None,
    population: str,
) -> tuple[str, str, str]:
    """Return three sentences on policies in the order of the table."""
    ranked = [policy for policy in policies if policy.rank is not None]
    budget = f"{budget_ms:.4g} ms"
    if not ranked:
        return _nobody(policies, budget, least_miss, population)
    first = [policy for policy in ranked if policy.rank == 1 and policy.same_as is None]
    return (
        _whom(first, budget, population),
        _how_sure(first, order, robustness, population),
        _who_misses(policies, budget),
    )


def sees_nothing(policy: PolicyResult) -> bool:
    """Whether a policy draws no error and no switch that can be seen."""
    error, pops = (policy.value_of(metric) or 0.0 for metric in SEEN)
    return error < _NOTHING_PX and pops < _NOTHING_POPS and not _holes(policy)


def _holes(policy: PolicyResult) -> str:
    """Return in words how much a policy leaves out, nothing where it draws all."""
    missing = policy.value_of("missing_objects_mean") or 0.0
    return f", with {missing:.2g} objects missing" if missing >= _NOTHING_MISSING else ""


def _whom(first: Sequence[PolicyResult], budget: str, population: str) -> str:
    leader = first[0]
    keeps = leader.keeps_budget
    assert keeps is not None, "who has a rank keeps the budget"
    what = (
        "and nothing of its picture error or switches can be seen, so the budget leaves room"
        if sees_nothing(leader)
        else f"at {_number(leader, SEEN[0])} px of visible error and "
        f"{_number(leader, SEEN[1])} visible pops a second{_holes(leader)}"
    )
    kept = f" (it kept {keeps.kept} of {keeps.paths} judged)" if keeps.paths > 1 else ""
    sentence = f"Take {_named(leader)}: it keeps {budget} on {population}{kept}, {what}"
    if len(first) == 1:
        return f"{sentence}."
    others = _listed([policy.label for policy in first[1:]])
    are = "is" if len(first) == 2 else "are"
    return f"{sentence}; {others} {are} not shown to be worse by more than the margin."


def _how_sure(
    first: Sequence[PolicyResult],
    order: Chances,
    robustness: Robustness | None,
    population: str,
) -> str:
    leader = first[0]
    if leader.label not in order.p_best:
        sure = f"How it does beyond {population} is not known from a single replay"
    else:
        every = (
            f"Over all {population}"
            if leader.keeps_budget is not None and leader.keeps_budget.paths > 1
            else f"Over all noise on {population}"
        )
        best, near = order.p_best[leader.label], order.p_near_best[leader.label]
        sure = (
            f"{every} it comes first with probability {best:.2f}, and "
            f"is within the margin of the first with {near:.2f}"
        )
    sure += _with_machine(leader)
    # Curves are of fewer paths: where they put another first, they say nothing of this one.
    if robustness is None or robustness.leader != leader.label:
        return f"{sure}."
    low, high = robustness.speed
    return (
        f"{sure}; read off the curves, it stays first on machines of {low:.2g} to {high:.2g} times "
        f"the speed{_with_costs(robustness)}."
    )


def _with_machine(leader: PolicyResult) -> str:
    """Return how surely the leader keeps the budget where the machine is not taken as known."""
    keeps = leader.keeps_budget
    if keeps is None or keeps.with_machine is None:
        return ""
    return (
        "; on a machine as uncertain as its profile says it keeps the budget with probability "
        f"{keeps.with_machine:.2f}"
    )


def _with_costs(robustness: Robustness) -> str:
    """Return with which unmeasured costs the leader stays first, and with which not."""
    stays = [item.cost for item in robustness.costs if item.stands]
    falls = [item.cost for item in robustness.costs if not item.stands]
    words = f", and with {_listed(stays)}" if stays else ""
    return f"{words}, but not with {_listed(falls)}" if falls else words


def _who_misses(policies: Sequence[PolicyResult], budget: str) -> str:
    missing = [
        policy
        for policy in policies
        if policy.status == "ok" and policy.rank is None and not policy.oracle
    ]
    missing = [policy for policy in missing if policy.same_as is None]
    if not missing:
        return "Every policy that was scored keeps the budget."
    by = [
        f"{policy.label} ({policy.keeps_budget.work_ms:.3g} ms)"
        for policy in missing
        if policy.keeps_budget is not None
    ]
    verb = "does" if len(by) == 1 else "do"
    return f"{_listed(by)} {verb} not surely keep {budget}."


def _nobody(
    policies: Sequence[PolicyResult], budget: str, least_miss: LeastMiss | None, population: str
) -> tuple[str, str, str]:
    if least_miss is None:
        return (
            "Nobody was scored but oracles, which see the true cost."
            if any(policy.status == "ok" for policy in policies)
            else "No policy was scored.",
            "Nothing can be said of how sure that is.",
            "See the reason of each below.",
        )
    nearest = next(policy for policy in policies if policy.label == least_miss.label)
    ratio = f"{least_miss.ratio:.2f} times it, in the geometric mean"
    return (
        f"No policy surely keeps {budget} on {population}.",
        f"Nearest comes {_named(nearest)}, whose work takes {ratio}.",
        _who_misses(policies, budget),
    )


def _named(policy: PolicyResult) -> str:
    knob = knob_text(policy)
    return f"{policy.label} with {knob}" if knob and knob not in policy.label else policy.label


def _number(policy: PolicyResult, metric: str) -> str:
    value = policy.value_of(metric)
    return "no" if value is None else f"{value:.2f}" if value < 10.0 else f"{value:.0f}"


def _listed(words: Sequence[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
