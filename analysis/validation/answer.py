"""What a validation comes to, in sentences that its numbers make."""

from collections.abc import Iterator

from .measures.machine_factor import advice
from .validation_result import Case, Decided, Validation

ORDERED_BY = "frame_ms_mean"
"""The metric whose order the sentences tell."""


def answer(validation: Validation) -> tuple[str, ...]:
    """Return the sentences."""
    return tuple(_sentences(validation))


def _sentences(validation: Validation) -> Iterator[str]:
    pooled = validation.pooled
    if pooled.machine is not None and pooled.machine.another:
        found = advice(pooled.machine, validation.hardware)
        yield f"{found[0].upper()}{found[1:]}."
    inside = pooled.inside
    if inside.share is not None:
        yield (
            f"Of {inside.counted} metrics measured, {inside.share:.0%} lie where "
            f"{validation.level:.0%} of recordings of the same path are expected."
        )
    if pooled.keeps_budget.asked:
        yield f"Who keeps the budget: {decided_text(pooled.keeps_budget)}."
    if pooled.first.asked:
        yield f"Who is first, or equal to the first: {decided_text(pooled.first)}."
    rank = pooled.ranks.get(ORDERED_BY)
    if rank is not None and rank.simulated is not None:
        yield (
            f"Of {rank.pairs} pairs of policies recordings tell {rank.apart} apart by "
            f"{ORDERED_BY}; over these Kendall's τ is {rank.simulated:.2f}."
        )
    errors = pooled.corrected or pooled.errors
    if errors is not None:
        found = f"{errors.model.mean_pct:+.1f} ± {errors.model.sd_pct:.1f} %"
        drift = ", the machine's drift divided out" if pooled.corrected else ""
        yield f"The model errs by {found} of a frame's time{drift}{_noise(errors.noise_pct)}."
    for case in validation.cases:
        for label, reason in case.failed.items():
            yield f"{label} has no result on {case_name(case)}: {reason}."


def _noise(noise_pct: float | None) -> str:
    return "" if noise_pct is None else f"; the machine alone scatters by {noise_pct:.1f} %"


def case_name(case: Case) -> str:
    """Return a case in words."""
    return f"{case.scene} along {case.trace}"


def decided_text(decided: Decided) -> str:
    """Return how many decisions agree, in words."""
    sure = decided.asked - decided.undecided
    return (
        f"{decided.as_measured} of {sure} decided as measured, {decided.undecided} of "
        f"{decided.asked} undecided"
    )
