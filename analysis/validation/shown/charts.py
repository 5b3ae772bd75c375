"""Charts of a validation: both series of every policy, and metric against metric."""

from collections.abc import Mapping, Sequence

import numpy as np

from ....sim.frame_log import FrameLog
from ...metrics.measured_frames import MeasuredFrames
from ...report.palette import COLORS, Ink
from ...report.plots import Axis, Line, Mark, Plot, Plots, Rule, line_of, mark_of, round_step
from ...report.series import envelope
from ..answer import case_name
from ..validation_result import Agreement, Case, Validation
from .texts import SHOWN

_POINTS, _LEAST_POINTS = 12_000, 40
"""Points of all lines of a page together: some 10 bytes each."""

MEASURED = Ink(COLORS[1], "solid", "circle", 1, 0)
AGAIN = Ink(COLORS[4], "dot", "circle", 4, 1)
SIMULATED = Ink(COLORS[0], "solid", "square", 0, 2)
_EQUAL = Ink("#888888", "dash", "circle", 6, -1)

Series = Mapping[str, tuple[Sequence[FrameLog], FrameLog]]
"""By label the recordings of a policy, and the simulated replay."""


def series_plots(case: Case, series: Series, number: int, lines: int) -> Plots:
    """Return frame times along the path, measured and simulated, one plot a policy.

    Parameters
    ----------
    number : of the case on its page
    lines : of all plots of the page, which share its points
    """
    buckets = max(_LEAST_POINTS, _POINTS // max(lines, 1) // 2)
    plots: list[Plot] = []
    for at, policy in enumerate(case.policies):
        measured, simulated = series[policy.label]
        runs = [
            (ink, MeasuredFrames(log, *case.window_s))
            for ink, log in (
                *zip((MEASURED, AGAIN), measured, strict=False),
                (SIMULATED, simulated),
            )
        ]
        high = max(float(run.work_ms.max()) for _, run in runs)
        x = Axis("time of the path, s", *case.window_s)
        y = Axis("ms", 0.0, 1.05 * max(high, case.budget_ms), parts=3)
        drawn = [
            line_of(ink, (x, y), envelope(run.time_s, run.work_ms, buckets)) for ink, run in runs
        ]
        below = round(100.0 * y.at(case.budget_ms), 2)
        budget = Rule(False, below, f"budget {case.budget_ms:.4g} ms")
        plots.append(
            Plot(
                f"series-{number}-{at}", f"{policy.label}: work time of each frame, ms", x, y,
                drawn, rules=[budget], height_px=130, link=f"case-{number}",
            )
        )  # fmt: skip
    return Plots(plots, zoom=f"case-{number}" if plots else "")


def agreement_plots(validation: Validation) -> Plots:
    """Return simulated against measured values with their intervals, one plot a metric."""
    return Plots([_agreement_plot(validation, name) for name in SHOWN], beside=True)


def _agreement_plot(validation: Validation, name: str) -> Plot:
    items = [
        (case, policy.label, policy.metrics[name])
        for case in validation.cases
        for policy in case.policies
        if policy.metrics[name].measured is not None and policy.metrics[name].simulated is not None
    ]
    top = max((_highest(item) for _, _, item in items), default=0.0)
    step = round_step(max(top, 1e-6) / 5.0)
    end = step * np.ceil(1.02 * max(top, 1e-6) / step)
    x, y = Axis("measured", 0.0, end), Axis("simulated", 0.0, end)
    ends = np.array([0.0, end])
    lines: list[Line] = [line_of(_EQUAL, (x, y), (ends, ends))]
    marks: list[Mark] = []
    for case, label, item in items:
        assert item.measured is not None
        assert item.simulated is not None
        ink = AGAIN if item.inside is False else SIMULATED
        words = f"{label}, {case_name(case)}"
        marks.append(mark_of(ink, (x, y), item.measured, item.simulated, words))
        if item.low is not None and item.high is not None:
            points = np.full(2, item.measured), np.array([item.low, item.high])
            lines.append(line_of(ink, (x, y), points))
    return Plot(
        f"agreement-{name}", name, x, y, lines, marks, height_px=260,
        caption="Orange: measured outside of the interval.",
    )  # fmt: skip


def _highest(item: Agreement) -> float:
    known = (item.measured, item.simulated, item.high)
    return max(value for value in known if value is not None)
