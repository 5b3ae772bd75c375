"""The leaderboard of a suite as a page: who leads, every comparison, and what each draws there."""

from collections.abc import Iterator, Sequence

from ...study.suite.suite_record import CellResult, Leader, Standing, SuiteResult
from ..blocks import Block, Cell, Command, Paragraph, Section, Table, Terms
from ..names import readable, short_name, whole_name
from ..page import render_page
from ..palette import Ink, inks_of
from ..plots import Axis, Plot, Plots, Rule, mark_of
from ..suite_table import mean_text, standing_of, standing_text
from ..values import counted, format_value

_DRAWN_AT_FIRST = 6
"""Policies, the first of the leaderboard, that charts show until a reader asks for more."""
_MOST = 3.0
"""Work that a chart shows, in budgets."""

_TERMS = (
    ("kept", "Comparisons whose budget the policy keeps with probability .9 or more on such paths"),
    ("mean rank", "Over the comparisons that it keeps"),
    ("1, 2, …", "A column a comparison: the rank there"),
    ("p", "Probability of keeping that budget, of a policy that may not"),
    ("n/a", "The policy does not fit the scene, such as one of flat scenes in a hierarchy"),
)


def render_suite(result: SuiteResult) -> str:
    """Return the HTML of a suite's result, which leads to the reports in the folders beside it.

    The same result gives the same bytes.
    """
    inked = inks_of(leader.label for leader in result.leaderboard)
    names = {leader.label: _name(leader, inked) for leader in result.leaderboard}
    sections = (
        Section("", "", tuple(_answer(result))),
        _leaderboard(result, names),
        _comparisons(result),
        _tradeoffs(result, inked),
        *_failures(result, names),
        _provenance(result),
    )
    many, cells = len(result.leaderboard), len(result.cells)
    return render_page(
        f"Suite {result.suite}",
        f"version {result.suite_version} · {counted(cells, 'comparison')} · "
        f"{counted(many, 'policy', 'policies')}",
        sections,
        list(names.values()),
        _DRAWN_AT_FIRST,
    )


def _name(leader: Leader, inked: dict[str, Ink]) -> Cell:
    label = leader.label
    tags = ("submitted",) if leader.submitted else ()
    return Cell(short_name(label), hint=whole_name(label), ink=inked[label], tags=tags)


def _answer(result: SuiteResult) -> Iterator[Block]:
    """Yield who leads, and where what was submitted stands."""
    cells = len(result.cells)
    first = [leader for leader in result.leaderboard if leader.place == 1]
    if not first or not first[0].kept:
        yield Paragraph("Nobody surely keeps any budget.", "lead")
    else:
        names = " and ".join(short_name(leader.label) for leader in first)
        verb = "lead" if len(first) > 1 else "leads"
        keeps = "each keeps" if len(first) > 1 else "it keeps"
        yield Paragraph(
            f"{names} {verb}: {keeps} the budget of {first[0].kept} of "
            f"{counted(cells, 'comparison')}, at a mean rank of {mean_text(first[0])}.",
            "lead",
        )
    for leader in result.leaderboard:
        if leader.submitted:
            yield Paragraph(
                f"{short_name(leader.label)}, submitted, is in place {leader.place} of "
                f"{len(result.leaderboard)}: {leader.kept} of {cells} kept."
            )
    yield Paragraph(
        "Places are by the number of budgets that a policy surely keeps, then by its mean rank "
        "over these: a policy that does not fit a scene does not keep its budget."
    )


def _leaderboard(result: SuiteResult, names: dict[str, Cell]) -> Section:
    numbers = [
        Cell(str(number), hint=cell.name) for number, cell in enumerate(result.cells, start=1)
    ]
    rows = [
        (
            Cell(str(leader.place), value=float(leader.place)),
            names[leader.label],
            Cell(f"{leader.kept}/{len(result.cells)}", value=float(leader.kept)),
            Cell(mean_text(leader), value=leader.mean_rank),
            *(_in_cell(standing_of(cell, leader.label)) for cell in result.cells),
        )
        for leader in result.leaderboard
    ]
    heads = ("place", "policy", "kept", "mean rank", *numbers)
    note = "Press a heading to sort by it; numbers are the comparisons below."
    table = Table(heads, rows, "ranking", "leaderboard")
    return Section("Leaderboard", note, (table, Terms("What the columns mean", _TERMS)))


def _in_cell(standing: Standing) -> Cell:
    """Return that word, and by what it is sorted: ranks, then who may not keep the budget."""
    if standing.rank is not None:
        value = float(standing.rank)
    elif standing.keeps is not None and standing.status == "ok":
        value = 1e3 + 1.0 - standing.keeps
    else:
        value = 1e4
    tone = "best" if standing.rank == 1 else ""
    knob = f"{standing.knob}; " if standing.knob else ""
    work = format_value(standing.work_ms_p99)
    hint = standing.reason or f"{knob}work {work} ms"
    return Cell(standing_text(standing), tone=tone, hint=hint, value=value)


def _comparisons(result: SuiteResult) -> Section:
    labels = [leader.label for leader in result.leaderboard]
    rows: list[Sequence[Cell | str]] = []
    for number, cell in enumerate(result.cells, start=1):
        said = [readable(text, labels) for text in (*cell.answer[:1], *cell.warnings)]
        name = Cell(f"{number}: {cell.name}", link=f"{cell.name}/report.html")
        rows.append((name, " ".join(said)))
    note = "Whom to take in each, by its own report."
    table = Table(("comparison", "answer"), rows, "texts")
    return Section("The comparisons", note, (table,))


def _tradeoffs(result: SuiteResult, inked: dict[str, Ink]) -> Section:
    note = (
        "Visible error in pixels over work: a point is a policy where its knob was set for the "
        "budget, which is dashed.  Lower is a finer picture, and left of the line is within the "
        "budget.  What is off the scale stands at its end."
    )
    plots = [
        plot
        for number, cell in enumerate(result.cells, start=1)
        if (plot := _error_over_work(cell, number, inked)) is not None
    ]
    return Section("What each policy draws for its work", note, (Plots(plots, beside=True),))


def _error_over_work(cell: CellResult, number: int, inked: dict[str, Ink]) -> Plot | None:
    """Return visible error over work in one comparison; None where nothing was scored."""
    points = [
        (one, one.work_ms_p99, one.visible_error_px)
        for one in cell.standings
        if one.work_ms_p99 is not None and one.visible_error_px is not None
    ]
    if not points:
        return None
    works = [cell.budget_ms, *(work for _, work, _ in points)]
    high = min(1.1 * max(works), _MOST * cell.budget_ms)
    x = Axis("work, ms", 0.9 * min(works), high, "log")
    y = Axis("visible error, px", 0.0, max(1.1 * max(error for *_, error in points), 1e-3), "root")
    marks = [
        mark_of(inked[one.label], (x, y), work, error, short_name(one.label))
        for one, work, error in points
    ]
    budget = Rule(True, round(100.0 * x.at(cell.budget_ms), 2), f"{cell.budget_ms:.4g} ms")
    finest = min(
        ((error, one) for one, _, error in points if one.rank is not None),
        key=lambda pair: pair[0],
        default=None,
    )
    caption = "Nobody surely keeps the budget."
    if finest is not None:
        name = short_name(finest[1].label)
        caption = f"{name} draws the finest picture within it, {format_value(finest[0])} px."
    return Plot(
        f"cell-{number}", f"{number}: {cell.name}", x, y, marks=marks, rules=[budget],
        height_px=180, caption=caption,
    )  # fmt: skip


def _failures(result: SuiteResult, names: dict[str, Cell]) -> Iterator[Section]:
    rows = [
        (names[one.label], cell.name, one.reason or "")
        for cell in result.cells
        for one in cell.standings
        if one.status == "failed"
    ]
    if rows:
        yield Section(
            "What failed", "", (Table(("policy", "comparison", "reason"), rows, "texts"),)
        )


def _provenance(result: SuiteResult) -> Section:
    facts = [
        ("suite", f"{result.suite}, version {result.suite_version}, {result.suite_hash[:12]}"),
        ("made by", f"lodbench {result.version}, code {result.code[:12]}"),
    ]
    inputs = [
        (cell.name, name, digest) for cell in result.cells for name, digest in cell.hashes.items()
    ]
    note = "Results may be set beside each other where suite and code are the same."
    blocks: list[Block] = [Command("To repeat it", result.command)] if result.command else []
    heads = ("comparison", "what went in", "its content")
    blocks += [
        Table((), facts, "facts"),
        Table(heads, inputs, "texts", folded="Contents of scenes, paths and machines"),
    ]
    return Section("Where the numbers come from", note, blocks)
