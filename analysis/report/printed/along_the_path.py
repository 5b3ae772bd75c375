"""Work time along the first path, a panel for each of the policies that matter most."""

from typing import Any

import numpy as np

from ....base.foreign_text import one_line
from ...metrics.measured_frames import MeasuredFrames
from ...study.comparison_parts import PolicyResult
from ..series import envelope
from .drawing import clear_spines, new_figure
from .sheet import BUDGET_COLOR, Sheet

_MOST = 6
_PANEL_IN, _AROUND_IN = 0.62, 0.5
_BUCKETS = 400  # minima and maxima of as many stretches as a page has dots
_OVER = "#D55E00"  # Okabe and Ito's vermilion
_LINE = "#0072B2"  # and their blue


def draw_along_the_path(sheet: Sheet) -> Any:
    """Draw the work time of the first policies of the ranking, and where it is over the budget."""
    policies = _chosen(sheet)
    budget_ms = sheet.comparison.budget_ms
    figure = new_figure(sheet.width_in, _PANEL_IN * len(policies) + _AROUND_IN)
    panels = figure.subplots(len(policies), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    names = sheet.names()
    highest = budget_ms
    for axes, policy in zip(panels, policies, strict=True):
        run = MeasuredFrames(sheet.logs[policy.label])
        time_s, work_ms = envelope(run.time_s, run.work_ms, _BUCKETS)
        clear_spines(axes)
        axes.set_axisbelow(True)
        axes.plot(time_s, work_ms, color=_LINE, lw=0.6)
        axes.fill_between(
            time_s, budget_ms, work_ms, where=work_ms > budget_ms, color=_OVER, lw=0.0,
            interpolate=True,
        )  # fmt: skip
        axes.axhline(budget_ms, color=BUDGET_COLOR, lw=0.7, ls="--")
        rank = "misses: " if policy.rank is None else f"rank {policy.rank}: "
        axes.set_title(f"{rank}{names[policy.label]}", loc="left", pad=2.0, fontsize="medium")
        highest = max(highest, float(np.nanquantile(run.work_ms, 0.99)))
    panels[0].set_title(
        sheet.budget_text(), loc="right", pad=2.0, color=BUDGET_COLOR, fontsize="medium"
    )
    panels[0].set_ylim(0.0, min(1.15 * highest, 4.0 * budget_ms))
    path = one_line(sheet.comparison.paths[0], 30)
    panels[-1].set_xlabel(f"time along {path}, s")
    figure.supylabel("work time, ms", fontsize="medium")
    return figure


def _chosen(sheet: Sheet) -> list[PolicyResult]:
    """Return the first of the ranking; where few keep the budget, those that miss it after them."""
    return [policy for policy in sheet.policies if not policy.oracle][:_MOST] or list(
        sheet.policies[:1]
    )
