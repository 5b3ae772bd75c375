"""How far policies' predictions of GPU time are from what the simulated machine took."""

import numpy as np

from ...metrics.lag import prediction_error_pct
from ...metrics.measured_frames import MeasuredFrames
from ..blocks import Paragraph
from ..plots import Axis, Plot, Plots, Rule, line_of
from ..results import Results, section
from ..series import envelope
from .along_the_trace import LINK, time_axis

_BUCKETS = 500
_LEAST_PCT, _MOST_PCT = 5.0, 100.0
"""Ends of the axis, at least and at most."""


@section("What policies predict")
def predictions(results: Results) -> tuple[Plots] | tuple[Paragraph]:
    """Predicted less simulated GPU time of each frame of the first path, in per cent of simulated.

    Zoomed with the charts along the path.  Policies that predict nothing are not drawn.
    """
    errors = {
        policy.label: (run.time_s, prediction_error_pct(run))
        for policy in results.drawn
        for run in (MeasuredFrames(results.logs[policy.label]),)
    }
    known = {label: points for label, points in errors.items() if np.isfinite(points[1]).any()}
    if not known:
        return (Paragraph("No policy predicts the time of a frame.", "dim"),)
    ends = [float(np.nanquantile(np.abs(pct), 0.99)) for _, pct in known.values()]
    end = min(max(1.2 * max(ends), _LEAST_PCT), _MOST_PCT)
    x, y = time_axis(results), Axis("error of prediction, %", -end, end)
    lines = [
        line_of(results.inks[label], (x, y), envelope(*points, _BUCKETS))
        for label, points in known.items()
    ]
    rule = Rule(False, 50.0, "as predicted")
    title = "Predicted less simulated GPU time"
    return (Plots([Plot("predicted", title, x, y, lines, rules=[rule], link=LINK)]),)
