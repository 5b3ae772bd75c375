"""The page of a validation: tables, charts, and where the numbers come from."""

from collections.abc import Iterator, Mapping

from ...base.version import __version__
from ..metrics.metric_registry import METRICS
from ..report.blocks import Cell, Chart, Section, Table
from ..report.page import render_page
from ..report.values import format_span, format_value
from .validate import Pair
from .validation_charts import agreement_chart, series_chart
from .validation_result import Errors, Validation
from .validation_table import COMPARED, RANKED, error_text, errors_of, rank_text


def render_validation(validation: Validation, pairs: Mapping[str, Pair]) -> str:
    """Return the HTML of a validation."""
    subtitle = (
        f"{validation.scene} along {validation.trace}, {validation.trace_s:.1f} s, drawn on "
        f"{validation.log.get('renderer', 'a device')} at "
        f"{validation.log.get('resolution', 'some size')} and simulated with the profile "
        f"{validation.hardware}; budget {validation.budget_ms:.4g} ms"
    )
    sections = (
        _frame_by_frame(validation),
        Section(
            "Measured and simulated along the trace",
            "Work time of each frame.  The dashed line is the budget.",
            (Chart("series", series_chart(validation, pairs)),),
        ),
        _metric_by_metric(validation),
        _every_metric(validation),
        Section("Where the numbers come from", "", (Table((), list(_facts(validation)), "facts"),)),
    )
    return render_page("Does the simulator agree with the machine?", subtitle, sections)


def _frame_by_frame(validation: Validation) -> Section:
    note = (
        "Error of frame times in per cent of those measured, mean ± standard deviation, with the "
        "5th and 95th percentile below.  Model of what was drawn: each recorded frame is priced by "
        "the profile; v_time: that follows the frames before; simulated replay: the simulator's "
        "own run at the same moment of the trace, with its own noise; recorded again: a second "
        "recording there, which shows how far the machine comes from itself."
    )
    rows = [_error_row(policy.label, policy.errors) for policy in validation.policies]
    rows.append(_error_row("all policies", validation.all_policies))
    return Section("Frame by frame", note, (Table(("policy", *COMPARED.values()), rows),))


def _error_row(label: str, errors: Errors) -> tuple[Cell | str, ...]:
    cells = (
        Cell(error_text(error), f"{error.p05_pct:.1f} to {error.p95_pct:.1f}" if error else "")
        for error in errors_of(errors)
    )
    return label, *cells


def _metric_by_metric(validation: Validation) -> Section:
    note = (
        f"Values on the dashed line agree; bars are {validation.level:.0%} intervals.  Kendall's τ "
        "says whether simulation and recording order the policies alike: 1 is the same order."
    )
    ranks = [
        (name, rank_text(validation, name), rank_text(validation, name, again=True))
        for name in RANKED
    ]
    heads = ("Kendall's τ", "simulated and measured", "measured twice")
    blocks = (Chart("agreement", agreement_chart(validation)), Table(heads, ranks, "metrics"))
    return Section("Metric by metric", note, blocks)


def _every_metric(validation: Validation) -> Section:
    note = (
        "Measured, with the simulated value and its interval below; green where the measured value "
        "is inside."
    )
    rows: list[tuple[Cell | str, ...]] = []
    for metric in METRICS:
        cells: list[Cell] = []
        for policy in validation.policies:
            item = policy.metrics[metric.id]
            span = ", ".join(
                filter(None, (format_value(item.simulated), format_span(item.low, item.high)))
            )
            tone = "best" if item.inside is True else ""
            cells.append(Cell(format_value(item.measured), span, tone))
        head = Cell(metric.id, hint=metric.definition)
        rows.append((head, metric.unit, *cells, rank_text(validation, metric.id)))
    heads = ("metric", "unit", *(policy.label for policy in validation.policies), "τ")
    table = Table(heads, rows, "metrics")
    return Section("Every metric of every policy", note, (table,), folded=True)


def _facts(validation: Validation) -> Iterator[tuple[str, str]]:
    yield "profile", f"{validation.hardware}: {validation.hardware_source}"
    yield "calibrated on", ", ".join(validation.measured_on) or "unknown"
    yield from validation.log.items()
    start_s, end_s = validation.window_s
    yield "window", f"{start_s:g} to {end_s:g} s of the path, the same for every policy"
    yield "draws", f"{validation.draws} posterior draws of the cost model"
    yield "made by", f"lodbench {__version__}"
