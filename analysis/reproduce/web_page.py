"""The experiments as a page of the report's own shell: claims, constants and charts."""

from collections.abc import Iterator, Sequence

import numpy as np

from ..report.blocks import Block, Cell, Command, Paragraph, Table
from ..report.blocks import Section as PageSection
from ..report.page import render_page
from ..report.palette import Ink, ink_at
from ..report.plots import (
    Axis,
    Line,
    Mark,
    Plot,
    Plots,
    label_height_px,
    label_marks,
    line_of,
    mark_of,
)
from ..report.values import counted
from .experiment import IN_DIRECTION, REPRODUCED, Chart
from .experiment import Line as ChartLine
from .reproduction import Entry, Reproduction, Section

_PRINTED, _HERE = 0, 1
"""What the legend rules: what a paper printed, and what came out."""
_PAPER = Ink("#000000", "dash", "square", 6, _PRINTED)
_LEGEND = (
    Cell("printed in the paper", ink=_PAPER),
    Cell("here", ink=ink_at(0, _HERE)),
)
_FEW = 20
"""Points that are marked each."""
_HEIGHT_PX = 260


def render_reproduction(result: Reproduction) -> str:
    """Return the HTML of experiments; the same record gives the same bytes."""
    sections = [
        PageSection("", "", tuple(_answer(result))),
        _claims(result),
        *map(_experiment, result.sections),
        _provenance(result),
    ]
    papers = len({section.experiment.id.partition("/")[0] for section in result.sections})
    experiments = counted(len(result.sections), "experiment")
    return render_page(
        "What the papers printed, and what comes out here",
        f"{experiments} of {counted(papers, 'paper')}",
        sections,
        _LEGEND,
    )


def _answer(result: Reproduction) -> Iterator[Block]:
    entries = tuple(result.entries)
    same, alike = (
        sum(entry.verdict == word for entry in entries) for word in (REPRODUCED, IN_DIRECTION)
    )
    yield Paragraph(
        f"Of {counted(len(entries), 'claim')}, {same} are reproduced, {alike} in direction, and "
        f"{len(entries) - same - alike} not.",
        "lead",
    )
    yield Paragraph(
        "Reproduced: within the tolerance given.  In direction: the effect is there, its size "
        "differs.  A constant is printed in the paper, assumed where it is not, or calibrated, "
        "that is chosen so that a printed figure comes out: a match that rests on such a one "
        "confirms nothing."
    )
    if result.reduced:
        yield Paragraph("This is the reduced size, as tests have it: verdicts are hints.", "warn")


def _claims(result: Reproduction) -> PageSection:
    rows = [(entry.id, entry.claim, _verdict(entry)) for entry in result.entries]
    table = Table(("experiment", "claim", "verdict"), rows, "texts", "claims")
    return PageSection("Every claim", "Press a heading to sort by it.", (table,))


def _verdict(entry: Entry) -> Cell:
    return Cell(entry.verdict, tone="best" if entry.verdict == REPRODUCED else "")


def _experiment(section: Section) -> PageSection:
    one = section.experiment
    heads = ("claim", "paper", "here", "tolerance", "verdict")
    rows = [(it.claim, it.paper, it.ours, it.tolerance, _verdict(it)) for it in section.entries]
    blocks: list[Block] = [Table(heads, rows, "texts")]
    if one.constants:
        constants = [(name, it.value, it.origin, it.source) for name, it in one.constants.items()]
        words = f"{counted(len(constants), 'constant')}, and where they are from"
        heads = ("constant", "value", "origin", "source")
        blocks.append(Table(heads, constants, "texts", folded=words))
    blocks += [Paragraph(_plain(note)) for note in section.notes]
    stem = one.id.replace("/", "-")
    if section.charts:
        blocks.append(Plots([_plot(f"{stem}-{chart.name}", chart) for chart in section.charts]))
    return PageSection(f"{one.id}: {one.title}", _plain(one.setting), blocks)


def _plain(text: str) -> str:
    """Return a text without the marks that Markdown has around names."""
    return text.replace("`", "")


def _plot(name: str, chart: Chart) -> Plot:
    """Return a chart whose lines are named at their last points."""
    axes = _axis(chart, "x"), _axis(chart, "y")
    height_px = label_height_px(len(chart.lines), _HEIGHT_PX)
    lines: list[Line] = []
    marks: list[Mark] = []
    ends: list[Mark] = []
    texts: list[str] = []
    place = 0
    for line in chart.lines:
        ink = _PAPER if line.printed else ink_at(place, _HERE)
        place += not line.printed
        points = _points(line, chart)
        if not points:
            continue
        x, y = (np.array(values) for values in zip(*points, strict=True))
        drawn = line_of(ink, axes, (x, y))
        lines.append(Line(ink, drawn.path, hint=line.label))
        at = [mark_of(ink, axes, *point, line.label) for point in points]
        marks += at if len(at) <= _FEW else ()
        ends.append(at[-1])
        texts.append(line.label)
    labels, leaders = label_marks(ends, texts, height_px)
    return Plot(
        name, f"{chart.y}, over {chart.x}", *axes, [*leaders, *lines], marks, labels,
        height_px=height_px, caption=chart.caption,
    )  # fmt: skip


def _points(line: ChartLine, chart: Chart) -> list[tuple[float, float]]:
    """Return the points that a chart can show: on a logarithmic axis those above zero."""
    return [
        (float(x), float(y))
        for x, y in zip(line.x, line.y, strict=True)
        if np.isfinite(x)
        and np.isfinite(y)
        and not (chart.log_x and x <= 0.0)
        and not (chart.log_y and y <= 0.0)
    ]


def _axis(chart: Chart, of: str) -> Axis:
    """Return an axis that holds all points, and zero where it is a linear one near to that."""
    at, log = (0, chart.log_x) if of == "x" else (1, chart.log_y)
    values = [point[at] for line in chart.lines for point in _points(line, chart)] or [1.0]
    low, high = min(values), max(values)
    title = chart.x if of == "x" else chart.y
    if log:
        return Axis(title, low / 1.1, 1.1 * high, "log", parts=8)
    margin = 0.04 * ((high - low) or abs(high) or 1.0)
    near_zero = 0.0 <= low <= 0.5 * high
    return Axis(title, 0.0 if near_zero else low - margin, high + margin, parts=8 - 3 * at)


def _provenance(result: Reproduction) -> PageSection:
    blocks: list[Block] = [Command("To repeat it", result.command)] if result.command else []
    facts: Sequence[tuple[str, str]] = (
        ("size", "reduced" if result.reduced else "full"),
        ("made by", f"lodbench {result.version}, code {result.code[:12]}"),
    )
    return PageSection("Where the numbers come from", "", (*blocks, Table((), facts, "facts")))
