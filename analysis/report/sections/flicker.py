"""When each policy's switches are seen: policy by time, coloured by visible pops."""

import numpy as np

from ....base.arrays import BoolArray, FloatArray
from ...metrics.flicker import visible_pops_per_s
from ...metrics.measured_frames import MeasuredFrames
from ..blocks import Paragraph
from ..names import short_name
from ..plots import HIGH, WIDE, Axis, Line, Plot, Plots, Row
from ..results import Results, section
from ..values import format_value
from .along_the_trace import LINK, time_axis

_BIN_S = 0.1
_HEATS = ("heat1", "heat2", "heat3", "heat4")
_FROM_PER_S = (0.0, 10.0, 50.0, 200.0)
"""Visible pops a second above which each shade begins."""


def _in_short(results: Results) -> str:
    pops = {p.label: visible_pops_per_s(results.first_path(p.label)) for p in results.drawn}
    known = {label: per_s for label, per_s in pops.items() if per_s is not None}
    first = results.first.label
    if first not in known:
        return ""
    most = max(known, key=known.__getitem__)
    text = f"{first} shows {format_value(known[first])} visible pops a second on this path"
    if known[most] == known[first]:
        return f"{text}, and nobody more."
    return f"{text}; {most}, which shows most, {format_value(known[most])}."


@section("When switches are seen", takeaway=_in_short)
def flicker(results: Results) -> tuple[Plots] | tuple[Paragraph]:
    """Each row is a policy along the first path, zoomed with the charts above.

    The darker, the more visible pops in that tenth of a second: any, then more than 10, 50 and 200
    a second.  An even row of shades is flicker; single bars are switches.
    """
    if not results.drawn:
        return (Paragraph("Nothing to draw in this run.", "dim"),)
    return (Plots([_raster(results)]),)


def _raster(results: Results) -> Plot:
    x = time_axis(results)
    edges = np.arange(0.0, x.high + _BIN_S, _BIN_S)
    rows: list[Row] = []
    for policy in results.drawn:
        run, ink = MeasuredFrames(results.logs[policy.label]), results.inks[policy.label]
        pops = np.histogram(run.time_s, edges, weights=run["visible_pops"])[0] / _BIN_S
        shade = np.searchsorted(_FROM_PER_S, pops, side="left") - 1
        boxes = [
            Line(ink, _boxes(x.place(edges), shade == level), style)
            for level, style in enumerate(_HEATS)
        ]
        rows.append(Row(ink, short_name(policy.label), boxes))
    title = "Visible pops of each policy"
    return Plot("flicker", title, x, Axis("", 0.0, 0.0), rows=rows, link=LINK)


def _boxes(edges: FloatArray, there: BoolArray) -> str:
    """Return the outline of the bins of a row: one box for each run of neighbours."""
    change = np.diff(np.concatenate(([0], there.astype(np.int8), [0])))
    starts, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1)
    left, right = (np.rint(WIDE * edges[at]).astype(np.int64).tolist() for at in (starts, ends))
    return "".join(f"M{a} 0H{b}V{HIGH}H{a}z" for a, b in zip(left, right, strict=True))
