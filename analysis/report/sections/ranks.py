"""The ranking: who keeps the budget, in order of what can be seen; then who misses it."""

from collections.abc import Iterator

from ...metrics.metric_registry import find_metric
from ...study.comparison_parts import PolicyResult
from ..blocks import Across, Cell, Paragraph, Table
from ..results import Results, section
from ..summary import (
    HEADLINE,
    MetricColumn,
    behind_text,
    keeps_text,
    knob_words,
    rank_text,
    shown_policies,
)
from ..terminal_table import explain

_GROUPS = {"misses": "Not surely within the budget", "oracle": "Oracles, which see the true cost"}


@section("Ranking")
def ranks(results: Results) -> tuple[Table, Paragraph]:
    """Policies that share a rank could not be told apart from the first of it, within the margin.

    Below each value stands its {level} interval.
    """
    heads = ("rank", "policy", "knob", "keeps", "behind by", *map(_head, HEADLINE))
    words = explain(results.comparison)
    return Table(heads, list(_rows(results)), "ranks"), Paragraph(words, "dim")


def _rows(results: Results) -> Iterator[tuple[Cell | str, ...] | Across]:
    before = ""
    for policy in shown_policies(results.comparison):
        rank = rank_text(policy)
        if rank in _GROUPS and rank != before:
            yield Across(_GROUPS[rank], "group")
        before = rank
        name = results.name_of(policy)
        cells = (results.value_of(policy, column) for column in HEADLINE)
        yield rank, name, knob_words(policy), _keeps(policy), behind_text(policy), *cells


def _keeps(policy: PolicyResult) -> Cell:
    keeps = policy.keeps_budget
    if keeps is None:
        return Cell("")
    return Cell(keeps_text(policy), f"{keeps.work_ms:.3g} ms")


def _head(column: MetricColumn) -> Cell:
    header = " ".join(column.header.split())
    return Cell(header, hint=find_metric(column.metric).definition)
