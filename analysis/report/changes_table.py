"""The changes between two comparisons as a table for a terminal."""

from typing import TYPE_CHECKING

from ..verdict.changes import Change, Changes, PolicyChange
from .console_tables import plain_table
from .values import format_value

if TYPE_CHECKING:  # rich is loaded by the command that prints
    from rich.console import Console


def print_changes(changes: Changes, console: "Console") -> None:
    """Print what changed beyond noise, and what else is different about the policies."""
    from rich.text import Text

    shown = shown_changes(changes)
    console.print(summarise(changes), markup=False)
    for difference in changes.conditions:
        console.print(
            f"warning: not under the same conditions: {difference}",
            style="yellow",
            markup=False,
        )
    if shown:
        table = plain_table()
        table.add_column("policy", overflow="fold")
        table.add_column("metric", no_wrap=True)
        for head in ("before", "after", "change"):
            table.add_column(head, justify="right", no_wrap=True)
        for change in shown:
            style = "bold red" if is_worse(change) else "bold green"
            values = (format_value(change.before), format_value(change.after), change_span(change))
            table.add_row(Text(change.policy), f"{change.metric}", *values, style=style)
        console.print("", table)
    for sentence in change_sentences(changes):
        console.print(sentence, markup=False)


def shown_changes(changes: Changes) -> list[Change]:
    """Return the changes beyond noise."""
    return [change for change in changes.metrics if change.beyond_noise]


def change_span(change: Change) -> str:
    """Return by how much a metric changed, with its interval."""
    return f"{change.after - change.before:+.3g} ({change.low:+.3g}, {change.high:+.3g})"


def is_worse(change: Change) -> bool:
    """Whether a metric changed for the worse."""
    rises = change.after > change.before
    return rises if change.better == "lower" else not rises


def change_sentences(changes: Changes) -> list[str]:
    """Return what else is different about policies, a sentence each."""
    shown = shown_changes(changes)
    return [
        *(sentence for policy in changes.policies for sentence in _sentences(policy, shown)),
        *(f"{label} was scored in the first only" for label in changes.only_before),
        *(f"{label} was scored in the second only" for label in changes.only_after),
    ]


def summarise(changes: Changes) -> str:
    """Return in a sentence how much changed, and how that was judged."""
    shown = sum(change.beyond_noise for change in changes.metrics)
    count = len(changes.metrics)
    how = "path by path" if changes.paired else "as two samples: their paths differ"
    what = f"{shown} of {count} metrics" if shown else f"None of {count} metrics"
    return f"{what} changed beyond noise, compared {how} (Holm, 5 % over all)."


def _sentences(policy: PolicyChange, shown: list[Change]) -> list[str]:
    found: list[str] = []
    if policy.rank_before != policy.rank_after:
        before, after = (
            "misses the budget" if rank is None else f"rank {rank}"
            for rank in (policy.rank_before, policy.rank_after)
        )
        found.append(f"{policy.policy}: {before}, now {after}")
    if policy.knob_before != policy.knob_after:
        found.append(f"{policy.policy}: {policy.knob_before}, now {policy.knob_after}")
    if policy.term and any(change.policy == policy.policy for change in shown):
        found.append(
            f"{policy.policy}: on the first path the cost of {policy.term} changed most, by "
            f"{policy.term_ms:+.3g} ms of {policy.side.upper()} time a frame"
        )
    return found
