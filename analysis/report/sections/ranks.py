"""The ranking: who keeps the budget, in order of what can be seen; then who misses it."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

from ...metrics.metric_registry import find_metric
from ...study.comparison_parts import PolicyResult
from ..blocks import Block, Cell, Paragraph, Table, Terms
from ..results import Results, section
from ..summary import (
    HEADLINE,
    MetricColumn,
    behind_text,
    folded,
    keeps_text,
    knob_words,
    unscored,
)
from ..terminal_table import explain
from ..values import ABSENT, counted

_KEEPS = "Probability that work time is within the budget on such paths; judged paths it kept"
_FIRST = "Probability of coming first on another such set of paths"
_BEHIND = "What told a policy from the rank before"
_BY = "Work time at the judged quantile, over the budget"


def _in_short(results: Results) -> str:
    contenders = [policy for policy in results.drawn if not policy.oracle]
    ranked = [policy for policy in contenders if policy.rank is not None]
    text = f"{len(ranked)} of {counted(len(contenders), 'policy', 'policies')} surely "
    text += "keep the budget" if len(ranked) != 1 else "keeps the budget"
    first = [policy.label for policy in ranked if policy.rank == 1]
    if not first:
        return f"{text}."
    shared = ", ".join(first[1:])
    return f"{text}; the first rank is {first[0]}'s{f', shared with {shared}' * bool(shared)}."


@section("Ranking", takeaway=_in_short)
def ranks(results: Results) -> tuple[Block, ...]:
    """Who keeps the budget, by what can be seen.

    “=” is not shown to be worse than the first of its rank.  Below each value stands its {level}
    interval.  Press a heading to sort by it.
    """
    ranked = [policy for policy in results.drawn if policy.rank is not None]
    oracles = [policy for policy in results.drawn if policy.oracle]
    misses = [policy for policy in results.drawn if policy not in (*ranked, *oracles)]
    blocks: list[Block] = []
    if ranked:
        heads = ("rank", "policy", "knob", Cell("keeps", hint=_KEEPS), *_heads(),
                 Cell("comes first", hint=_FIRST), Cell("behind by", hint=_BEHIND))  # fmt: skip
        blocks.append(Table(heads, list(_ranked(results, ranked)), "ranking", "ranking"))
    if misses:
        words = f"{len(misses)} not surely within the budget, and by how much"
        blocks.append(_missing(results, misses, "misses", words))
    if oracles:
        words = f"Oracles, which see the true cost: {len(oracles)}, out of the ranking"
        blocks.append(_missing(results, oracles, "oracles", words))
    blocks += [Paragraph(results.words(text), "dim") for text in folded(results.comparison)]
    if results.drawn:
        words = results.words(explain(results.comparison))
        blocks += [_terms(), Paragraph(words, "dim")]
    unfit = [text for status, text in unscored(results.comparison) if status != "failed"]
    return (*blocks, *(Paragraph(results.words(text), "not-applicable") for text in unfit))


def _ranked(results: Results, policies: Sequence[PolicyResult]) -> Iterator[tuple[Cell | str, ...]]:
    shared = [False] + [above.rank == policy.rank for above, policy in pairwise(policies)]
    for place, (policy, equal) in enumerate(zip(policies, shared, strict=True)):
        p_best = results.comparison.p_best.get(policy.label)
        first = Cell(ABSENT) if p_best is None else Cell(f"{p_best:.2f}", value=p_best)
        rank = Cell(
            f"{policy.rank}{' =' if equal else ''}",
            tone="equal" if equal else "",
            value=float(place),
        )
        yield rank, *_common(results, policy, _keeps(policy)), first, behind_text(policy)


def _missing(results: Results, policies: Sequence[PolicyResult], name: str, words: str) -> Table:
    heads = (Cell("work / budget", hint=_BY), "policy", "knob", Cell("keeps", hint=_KEEPS))
    rows = [
        (_by_how_much(results, policy), *_common(results, policy, _keeps(policy)))
        for policy in policies
    ]
    return Table((*heads, *_heads()), rows, "ranking", name, words)


def _common(results: Results, policy: PolicyResult, keeps: Cell) -> tuple[Cell | str, ...]:
    values = (results.value_of(policy, column) for column in HEADLINE)
    return results.name_of(policy), knob_words(policy), keeps, *values


def _by_how_much(results: Results, policy: PolicyResult) -> Cell:
    keeps = policy.keeps_budget
    if keeps is None:
        return Cell(ABSENT)
    ratio = keeps.work_ms / results.comparison.budget_ms
    return Cell(f"{ratio:.2f} ×", value=ratio)


def _keeps(policy: PolicyResult) -> Cell:
    keeps = policy.keeps_budget
    if keeps is None:
        return Cell(ABSENT)
    sort = keeps.kept / keeps.paths if keeps.probability is None else keeps.probability
    return Cell(keeps_text(policy), f"{keeps.work_ms:.3g} ms", value=sort)


def _heads() -> tuple[Cell, ...]:
    return tuple(_head(column) for column in HEADLINE)


def _head(column: MetricColumn) -> Cell:
    header = " ".join(column.header.split())
    return Cell(header, hint=find_metric(column.metric).definition)


def _terms() -> Terms:
    columns = ((" ".join(c.header.split()), find_metric(c.metric).definition) for c in HEADLINE)
    words = (
        ("keeps", _KEEPS),
        *columns,
        ("comes first", _FIRST),
        ("behind by", _BEHIND),
        ("work / budget", _BY),
    )
    return Terms("What the columns mean", words)
