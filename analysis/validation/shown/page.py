"""The page of a validation: the answer, decisions, errors, charts, and where numbers come from."""

from collections.abc import Iterator, Mapping

from ....base.version import __version__
from ...metrics.metric_registry import METRICS
from ...report.blocks import Across, Block, Cell, Command, Paragraph, Section, Table
from ...report.page import render_page
from ...report.values import format_span, format_value
from ..answer import case_name
from ..validation_result import Case, Errors, PolicyValidation, Validation
from .charts import AGAIN, MEASURED, SIMULATED, Series, agreement_plots, series_plots
from .texts import (
    COMPARED,
    SHOWN,
    decision_text,
    error_text,
    errors_of,
    judged_text,
    noise_text,
    rank_text,
    slope_text,
)

_LEGEND = (
    Cell("measured", ink=MEASURED),
    Cell("measured again", ink=AGAIN),
    Cell("simulated", ink=SIMULATED),
)


def render_validation(validation: Validation, series: Mapping[int, Series]) -> str:
    """Return the HTML of a validation.

    Parameters
    ----------
    series
        By the number of the case: what was measured and simulated of its policies.
    """
    cases = len(validation.cases)
    subtitle = (
        f"{cases} {'path' if cases == 1 else 'paths'} drawn, and simulated with the profile "
        f"{validation.hardware}: {', '.join(map(case_name, validation.cases))}"
    )
    sections = (
        _answer(validation),
        _verdicts(validation),
        _metrics(validation),
        _frame_by_frame(validation),
        *_along_the_paths(validation, series),
        _every_metric(validation),
        Section("Where the numbers come from", "", (Table((), list(_facts(validation)), "facts"),)),
    )
    title = "Does the simulator agree with the machine?"
    return render_page(title, subtitle, sections, _LEGEND)


def _answer(validation: Validation) -> Section:
    blocks: list[Block] = [Paragraph(sentence) for sentence in validation.answer]
    machine = validation.pooled.machine
    if machine is not None and machine.another:
        command = "lodbench record --calibrate --scene plaza --out calibration.parquet"
        blocks.append(Command("calibrate this machine", command))
    return Section("The answer", "", blocks)


def _verdicts(validation: Validation) -> Section:
    note = (
        "Who keeps the budget (the 99th percentile over time of work), and who is first or equal "
        "to the first: what the replicates decide (nine in ten of them), with their share, and "
        "what was measured.  Open: two recordings say differently."
    )
    heads = ("policy", "p99 measured, ms", "keeps the budget", "first or equal to it")
    rows: list[tuple[Cell | str, ...] | Across] = []
    for case in validation.cases:
        rows.append(Across(f"{case_name(case)}, budget {case.budget_ms:.4g} ms", "group"))
        rows += [
            (
                policy.label,
                judged_text(policy),
                *(
                    Cell(decision_text(item), tone="best" if item.as_measured else "")
                    for item in (policy.keeps_budget, policy.first)
                ),
            )
            for policy in case.policies
        ]
        rows += [(label, "failed", reason, "") for label, reason in case.failed.items()]
    return Section("The verdict, simulated and measured", note, (Table(heads, rows),))


def _metrics(validation: Validation) -> Section:
    note = (
        f"Bars are where {validation.level:.0%} of recordings of the same path are expected: over "
        f"{validation.replicates} simulated ones, each with a draw of the machine and noise of its "
        "own.  Values on the dashed line agree.  Kendall's τ is over the pairs of policies that "
        "two recordings tell apart; its interval is that over the replicates."
    )
    ranks = [
        (name, rank_text(rank), "" if rank.again is None else f"{rank.again:.2f}")
        for name in SHOWN
        if (rank := validation.pooled.ranks.get(name)) is not None
    ]
    heads = ("Kendall's τ", "simulated and measured", "measured twice, all pairs")
    inside = [
        (name, f"{count} of {of}", f"{count / of:.0%}")
        for name, (count, of) in validation.pooled.inside.by_metric.items()
    ]
    pooled = validation.pooled.inside
    if pooled.share is not None:
        inside.append(("all", f"{pooled.inside} of {pooled.counted}", f"{pooled.share:.0%}"))
    return Section(
        "Metric by metric",
        note,
        (
            agreement_plots(validation),
            Table(heads, ranks, "metrics"),
            Table(("metrics that count", "inside", "share"), inside, "metrics"),
        ),
    )


def _frame_by_frame(validation: Validation) -> Section:
    note = (
        "Error of frame times in per cent of those measured, mean ± standard deviation.  Model of "
        "what was drawn: each recorded frame is priced by the profile; v_time: that follows the "
        "frames before; simulated replay: the simulator's own run at the same moment of the path; "
        "recorded again: a second recording there; for what was drawn: the same, with what was "
        "drawn in each divided out.  Noise alone: its deviation over √2, and the model's as a "
        "multiple of it.  Detail: how the model's error changes from no triangle of those in view "
        "to all."
    )
    rows: list[tuple[Cell | str, ...] | Across] = []
    for case in validation.cases:
        rows.append(Across(case_name(case), "group"))
        rows += [_error_row(policy.label, policy.errors, policy) for policy in case.policies]
        if case.all_policies is not None:
            rows.append(_error_row("all policies", case.all_policies))
        if case.all_corrected is not None:
            rows.append(_error_row("all policies, drift divided out", case.all_corrected))
    heads = ("policy", *COMPARED.values(), "noise alone", "detail")
    return Section("Frame by frame", note, (Table(heads, rows),))


def _error_row(
    label: str, errors: Errors, policy: PolicyValidation | None = None
) -> tuple[Cell | str, ...]:
    cells = (
        Cell(error_text(error), f"{error.p05_pct:.1f} to {error.p95_pct:.1f}" if error else "")
        for error in errors_of(errors)
    )
    slope = "" if policy is None else slope_text(policy.detail)
    return label, *cells, noise_text(errors), slope


def _along_the_paths(validation: Validation, series: Mapping[int, Series]) -> Iterator[Section]:
    lines = 3 * sum(len(case.policies) for case in validation.cases)
    for number, case in enumerate(validation.cases):
        if number in series:
            yield Section(
                f"Along the path: {case_name(case)}",
                "Work time of each frame.  The dashed line is the budget.",
                (series_plots(case, series[number], number, lines),),
                folded=number > 0,
            )


def _every_metric(validation: Validation) -> Section:
    note = (
        "Measured, with the simulated median and its interval below; green where the measured "
        "value is inside.  Framed: cells that count."
    )
    tables = tuple(_metrics_of(case) for case in validation.cases)
    return Section("Every metric of every policy", note, tables, folded=True)


def _metrics_of(case: Case) -> Table:
    rows: list[tuple[Cell | str, ...]] = []
    for metric in METRICS:
        cells: list[Cell] = []
        for policy in case.policies:
            item = policy.metrics[metric.id]
            parts = (format_value(item.simulated), format_span(item.low, item.high))
            tone = "best" if item.inside is True else ""
            tags = ("counts",) if item.counted else ()
            text = format_value(item.measured)
            cells.append(Cell(text, ", ".join(filter(None, parts)), tone, tags=tags))
        head = Cell(metric.id, hint=metric.definition)
        rows.append((head, metric.unit, *cells, rank_text(case.ranks.get(metric.id))))
    heads = (case_name(case), "unit", *(policy.label for policy in case.policies), "τ")
    return Table(heads, rows, "metrics")


def _facts(validation: Validation) -> Iterator[tuple[str, str]]:
    yield "profile", f"{validation.hardware}: {validation.hardware_source}"
    yield "calibrated on", ", ".join(validation.measured_on) or "unknown"
    yield "replicates", f"{validation.replicates}, under {validation.draws} draws of the machine"
    machine = validation.pooled.machine
    if machine is not None:
        yield (
            "measured over predicted",
            f"{machine.factor:.2f}, {machine.low:.2f} to {machine.high:.2f} by policy and path",
        )
    for case in validation.cases:
        start_s, end_s = case.window_s
        yield case_name(case), f"{start_s:g} to {end_s:g} s of the path, seed {case.seed}"
        if case.drift is not None:
            drift = case.drift
            yield (
                "drift of a drawing that is always the same",
                f"sd {drift.sd_pct:.1f} %, {drift.low_pct:+.1f} to {drift.high_pct:+.1f} %",
            )
        yield from case.log.items()
    yield "made by", f"lodbench {__version__}"
