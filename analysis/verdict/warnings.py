"""Why paths and budget may not tell policies apart: each with the number that shows it."""

from collections.abc import Sequence

from ..metrics.footing import Footing

_NOTHING = 0.5
"""Share of a window without anything in view from which it is no test of detail."""


def find_warnings(
    paths: Sequence[str], footings: Sequence[Footing], budget_ms: float, keeps: Sequence[bool]
) -> tuple[str, ...]:
    """Return a sentence for each reason.

    Parameters
    ----------
    paths, footings
        Names of the paths, and what each has to show.
    keeps
        Of each scored policy, whether it keeps the budget.
    """
    found = [
        f"on {name} nothing is in view for {footing.empty_fraction:.0%} of the window; take "
        "another path or window"
        for name, footing in zip(paths, footings, strict=True)
        if footing.empty_fraction >= _NOTHING
    ]
    most = max((footing.full_gpu_ms for footing in footings), default=0.0)
    if footings and most <= budget_ms:
        found.append(
            f"full detail of all in view takes {most:.3g} ms at most, within the budget of "
            f"{budget_ms:.4g} ms: no policy has to choose; take a lower budget"
        )
    elif keeps and not any(keeps):
        found.append(
            f"no policy surely keeps {budget_ms:.4g} ms, where full detail takes {most:.3g} ms; "
            "take a higher budget"
        )
    return tuple(found)
