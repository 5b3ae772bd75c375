"""What a capture holds as a page: one file of HTML."""

from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ..report.blocks import Chart, Paragraph, Section, Table
from ..report.page import render_page
from ..report.series import envelope, tail
from ..report.values import format_value

_BUCKETS, _POINTS = 600, 300
_SERIES = {"frames": "from frame to frame", "displays": "between displays"}


def render_capture(record: dict[str, Any], intervals: dict[str, FloatArray]) -> str:
    """Return the HTML of a record of `capture_record`; the same record gives the same bytes."""
    subtitle = f"{record['format']}, {record['frames']:,} frames; {record['median_frame']}"
    sections = [_findings(record), _columns(record)]
    if intervals:
        sections = [*sections[:1], _times(intervals), _metrics(record), *sections[1:]]
    return render_page(f"What {record['log']} holds", subtitle, sections)


def _findings(record: dict[str, Any]) -> Section:
    texts = [finding["message"] for finding in record["findings"]] + record["warnings"]
    blocks = [Paragraph(text) for text in texts or ["Nothing was found to beware of."]]
    return Section("What to beware of", "", blocks)


def _times(intervals: dict[str, FloatArray]) -> Section:
    from plotly.graph_objects import Figure

    along, slow = Figure(), Figure()
    for name, values in intervals.items():
        x, y = envelope(np.cumsum(values) / 1e3, values, _BUCKETS)
        along.add_scattergl(x=x.tolist(), y=y.tolist(), name=_SERIES[name], mode="lines")
        x, share = tail(values, values, _POINTS)
        slow.add_scattergl(
            x=x.tolist(), y=(100.0 * share).tolist(), name=_SERIES[name], mode="lines"
        )
    along.update_layout(xaxis_title="s", yaxis_title="ms", height=340)
    slow.update_layout(xaxis_title="ms", yaxis_title="time in frames at least this slow, %")
    slow.update_yaxes(type="log", dtick=1)
    slow.update_layout(height=340)
    note = "Extremes of every stretch are kept."
    return Section("Frame times", note, [Chart("along", along), Chart("slow", slow)])


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
