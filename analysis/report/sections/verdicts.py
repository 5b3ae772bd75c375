"""What to know first: cautions, policies without scores, and who leads in what."""

from ...study.comparison import PolicyResult
from ..blocks import Cell, Paragraph, Tile, Tiles
from ..results import Results, section
from ..summary import best_labels, unscored
from ..values import format_span, format_value

_LEADERS = (
    ("Budget kept best", "over_budget_time_fraction"),
    ("Steadiest frames", "frame_ms_sd"),
    ("Least lag", "lag_ms_mean"),
    ("Least flicker", "visible_pops_per_s"),
    ("Least error", "visible_error_px"),
)
_MOST_NAMED = 3
"""Policies of equal score that are named as leaders; the table below marks them all."""


@section("")
def verdicts(results: Results) -> tuple[Paragraph | Tiles, ...]:
    """Who leads in what, and who has no scores."""
    comparison = results.comparison
    cautions: list[Paragraph] = []
    if comparison.conditions.hardware_assumed:
        text = (
            f"The hardware profile {comparison.hardware} is assumed, not measured: the page "
            "compares policies, it does not predict a machine."
        )
        cautions.append(Paragraph(text, "warn"))
    cautions += [Paragraph(text, status) for status, text in unscored(comparison)]
    tiles = Tiles([_tile(results, title, metric) for title, metric in _LEADERS])
    return *cautions, tiles


def _tile(results: Results, title: str, metric: str) -> Tile:
    labels = best_labels(results.comparison, metric)
    best = [policy for policy in results.comparison.ok if policy.label in labels]
    names = [results.name_of(policy) for policy in best[:_MOST_NAMED]] or [Cell("no difference")]
    if len(best) > _MOST_NAMED:
        names.append(Cell(f"and {len(best) - _MOST_NAMED} more"))
    return Tile(title, names, f"{metric} {_amount(best[0], metric)}" if best else metric)


def _amount(policy: PolicyResult, metric: str) -> str:
    """Return value, unit and interval, fractions in per cent."""
    score = policy.metrics[metric]
    percent = score.unit == "fraction"
    text = f"{format_value(score.value, percent=percent)} {'%' if percent else score.unit}"
    if score.low == score.high:
        return text
    return f"{text} ({format_span(score.low, score.high, percent=percent)})"
