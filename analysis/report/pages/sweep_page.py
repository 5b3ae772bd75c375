"""The results of a study as a page: each metric over each axis, and what depends on what."""

from collections.abc import Iterator, Sequence

from ....base.errors import InputError
from ...metrics.metric_registry import find_metric
from ...study.sweep.query import Query
from ...study.sweep.sensitivities import Sensitivities, find_sensitivities
from ..blocks import Block, Cell, Paragraph, Section, Table, Tile, Tiles
from ..names import readable, short_name, whole_name
from ..page import render_page
from ..palette import Ink, inks_of
from ..plots import Plots
from ..values import counted, format_value
from .axis_plots import axis_plots, cell_text
from .sensitivity_plots import largest_share, sensitivity_blocks, share_text

_DRAWN_AT_FIRST = 6
"""Policies that charts show until a reader asks for more, in the order of the study."""
_REASONS, _VALUES = 10, 20
"""Reasons for which runs have no scores, and values of an axis, that are listed."""


def render_sweep(query: Query, metrics: Sequence[str], where: str | None = None) -> str:
    """Return the HTML of the runs that a query holds; the same runs give the same bytes.

    Parameters
    ----------
    metrics
        What is shown, by id.
    where
        The query's condition, which the page repeats.
    """
    labels = [str(group.cells[0]) for group in query.groups(["policy"], [])]
    inked = inks_of(labels)
    names = {
        label: Cell(short_name(label), hint=whole_name(label), ink=ink)
        for label, ink in inked.items()
    }
    found = _sensitivities(query, metrics)
    sections = (
        Section("", "", tuple(_answer(query, labels, found, where))),
        _multiples(query, metrics, inked),
        _dependence(found),
        _by_policy(query, metrics, names),
        _axes(query),
    )
    return render_page(
        f"Study {short_name(query.results.name)}",
        f"{counted(len(query), 'run')} · {counted(len(labels), 'policy', 'policies')}",
        sections,
        list(names.values()),
        _DRAWN_AT_FIRST,
    )


def _sensitivities(query: Query, metrics: Sequence[str]) -> Sensitivities | str:
    """Return how the variance of each metric is split, or why it cannot be."""
    try:
        return find_sensitivities(query, metrics)
    except InputError as error:
        return str(error)


def _answer(
    query: Query, labels: Sequence[str], found: Sensitivities | str, where: str | None
) -> Iterator[Block]:
    """Yield what each metric depends on most, and which runs have no scores."""
    tiles: list[Tile] = []
    for item in () if isinstance(found, str) else found.metrics:
        if item.shares:
            most, share = largest_share(item)
            detail = f"{share_text(share)} of its variance"
            tiles.append(Tile(f"{item.metric} is explained most by", (most,), detail))
    if tiles:
        yield Tiles(tiles)
    if where is not None:
        yield Paragraph(f"Runs for which {where}.")
    reasons = query.unscored()
    for one in reasons[:_REASONS]:
        yield Paragraph(readable(one.text, labels), one.status)
    if len(reasons) > _REASONS:
        yield Paragraph(f"and {counted(len(reasons) - _REASONS, 'more reason')}", "dim")


def _multiples(query: Query, metrics: Sequence[str], inked: dict[str, Ink]) -> Section:
    note = (
        "Means over all other axes, one row a metric: where combinations are left out, points of "
        "one chart are over different runs.  Policies stand beside each other at names that are no "
        "numbers."
    )
    rows = [Plots(plots, beside=True) for plots in axis_plots(query, metrics, inked) if plots]
    nothing = Paragraph("No axis but the policy has two values.", "dim")
    return Section("Each metric over each axis", note, rows or (nothing,))


def _dependence(found: Sensitivities | str) -> Section:
    note = (
        "Shares of each metric's variance over a full grid of runs: what an axis explains by "
        "itself, what axes explain only together, and what differs between seeds.  A bar is where "
        "90 % of other seeds would put it.  They are of the values in this study: another range "
        "has other shares."
    )
    blocks = (Paragraph(found, "dim"),) if isinstance(found, str) else sensitivity_blocks(found)
    return Section("What depends on what", note, blocks)


def _by_policy(query: Query, metrics: Sequence[str], names: dict[str, Cell]) -> Section:
    rows = [
        (
            names[str(group.cells[0])],
            Cell(f"{group.ok:,}", value=float(group.ok)),
            *(Cell(format_value(mean), value=mean) for mean in group.means),
        )
        for group in query.groups(["policy"], metrics)
    ]
    kinds = [find_metric(metric) for metric in metrics]
    columns = (Cell(f"{kind.id}, {kind.unit}", hint=kind.definition) for kind in kinds)
    note = "Means over all runs that have a score.  Press a heading to sort by it."
    table = Table(("policy", "runs", *columns), rows, name="policies")
    return Section("By policy", note, (table,))


def _axes(query: Query) -> Section:
    """Return what each axis has, as far as there is room."""
    facts: list[tuple[str, str]] = []
    for name in query.results.axes:
        cells = query.rows([name]).column(0).unique().to_pylist()
        texts = [short_name(cell_text(cell)) for cell in cells[:_VALUES]]
        more = f" and {len(cells) - _VALUES:,} more" if len(cells) > _VALUES else ""
        facts.append((name, ", ".join(texts) + more))
    facts.append(("runs", f"{len(query):,} of {query.results.runs:,} in the study"))
    return Section("The axes", "", (Table((), facts, "facts"),))
