"""What a capture holds as a page: one file of HTML."""

from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ..report.blocks import Cell, Paragraph, Section, Table
from ..report.page import render_page
from ..report.palette import COLORS, Ink
from ..report.plots import Axis, Line, Plot, Plots, line_of
from ..report.series import envelope, tail
from ..report.values import format_value

_BUCKETS, _POINTS = 600, 300
_SERIES = {"frames": "from frame to frame", "displays": "between displays"}
_INKS = {
    "frames": Ink(COLORS[0], "solid", "circle", 0, 0),
    "displays": Ink(COLORS[1], "dash", "square", 1, 1),
}
_LEAST_PCT = 0.01


def render_capture(record: dict[str, Any], intervals: dict[str, FloatArray]) -> str:
    """Return the HTML of a record of `capture_record`; the same record gives the same bytes."""
    subtitle = f"{record['format']}, {record['frames']:,} frames; {record['median_frame']}"
    sections = [_findings(record), _columns(record)]
    if intervals:
        sections = [*sections[:1], _times(intervals), _metrics(record), *sections[1:]]
    legend = [Cell(_SERIES[name], ink=_INKS[name]) for name in intervals]
    return render_page(f"What {record['log']} holds", subtitle, sections, legend)


def _findings(record: dict[str, Any]) -> Section:
    texts = [finding["message"] for finding in record["findings"]] + record["warnings"]
    blocks = [Paragraph(text) for text in texts or ["Nothing was found to beware of."]]
    return Section("What to beware of", "", blocks)


def _times(intervals: dict[str, FloatArray]) -> Section:
    highest_ms = 1.05 * max(float(values.max()) for values in intervals.values())
    ends_s = [float(values.sum()) / 1e3 for values in intervals.values()]
    along = Axis("s", 0.0, max(ends_s), parts=8), Axis("ms", 0.0, highest_ms)
    slow = Axis("ms", 0.0, highest_ms, parts=8), Axis("%", _LEAST_PCT, 100.0, "log")
    series: list[Line] = []
    tails: list[Line] = []
    for name, values in intervals.items():
        points = envelope(np.cumsum(values) / 1e3, values, _BUCKETS)
        series.append(line_of(_INKS[name], along, points))
        x, share = tail(values, values, _POINTS)
        tails.append(line_of(_INKS[name], slow, (x, 100.0 * share)))
    plots = (
        Plot("along", "Time of each frame, ms", *along, series, height_px=260, link="time"),
        Plot("slow", "Time in frames at least this slow, %", *slow, tails, height_px=260),
    )
    note = "Extremes of every stretch are kept."
    return Section("Frame times", note, [Plots(plots[:1], zoom="time"), Plots(plots[1:])])


def _metrics(record: dict[str, Any]) -> Section:
    series = list(record["intervals"])
    heads = ["metric", *(_SERIES[name] for name in series), "unit"]
    rows = [
        [name, *(format_value(row.get(at)) for at in series), row["unit"]]
        for name, row in record["metrics"].items()
    ]
    return Section("Metrics", "Definitions as of replays.", [Table(heads, rows, "metrics")])


def _columns(record: dict[str, Any]) -> Section:
    rows = [
        [
            column["name"],
            column["source"],
            column["why"] or column["unit"],
            format_value(column["median"]),
            str(column["missing"]),
        ]
        for column in record["columns"]
    ]
    table = Table(["column", "of the file", "in", "median", "missing"], rows, "facts")
    notes = [Paragraph(note) for note in record["notes"]]
    return Section("Columns", "", [table, *notes])
