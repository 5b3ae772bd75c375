"""GPU time as policies predicted it, as the simulator charged it, and whether anybody measured."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ....base.arrays import FloatArray
from ...metrics.lag import prediction_error_pct
from ...metrics.measured_frames import MeasuredFrames
from ...study.comparison_parts import PolicyResult
from ..blocks import Block, Cell, Paragraph, Plots, Table
from ..palette import Ink
from ..plots import Axis, Line, Plot, Rule, line_of
from ..results import Results, section
from ..series import envelope
from ..summary import MetricColumn
from ..values import format_value
from .along_the_trace import LINK, time_axis

_BUCKETS = 500
_PARTS = 24
"""Groups of frames of equal number, by predicted time, that the first chart takes medians of."""
_LEAST_PCT, _MOST_PCT = 5.0, 100.0
"""Ends of the axis of errors, at least and at most."""
_NEAR_PCT = 10.0
_ERROR = "prediction_error_pct_mean"


def _in_short(results: Results) -> str:
    errors = {p.label: pct for p in results.drawn if (pct := p.value_of(_ERROR)) is not None}
    if not errors:
        return ""
    nearest, farthest = min(errors, key=errors.__getitem__), max(errors, key=errors.__getitem__)
    least, most = (format_value(errors[label]) for label in (nearest, farthest))
    if least != most:
        return (
            f"{nearest} predicts a frame's GPU time to {least} % on average, the nearest; "
            f"{farthest} to {most} %, the farthest."
        )
    who = nearest if len(errors) == 1 else f"{len(errors)} policies"
    return f"{who} predict{'s' * (len(errors) == 1)} a frame's GPU time to {least} % on average."


@section("Predicted, simulated, measured", takeaway=_in_short)
def predictions(results: Results) -> tuple[Block, ...]:
    """GPU time of frames of the first path; policies that predict nothing are not drawn.

    On the dashed diagonal frames take what was predicted; above it the policy predicted too little.
    Lines are medians over frames of like prediction.  The chart along the path is zoomed with the
    others.  No policy knows the noise of a frame before it is drawn.
    """
    unmeasured = Paragraph(results.words(_who_measured(results)))
    known = [each for p in results.drawn if (each := _predicted(results, p)) is not None]
    if not known:
        return Paragraph("No policy predicts the time of a frame.", "dim"), unmeasured
    plots = Plots([_over_predicted(results, known), _along_the_path(results, known)])
    return plots, _table(results, known), unmeasured


@dataclass(frozen=True, slots=True)
class _Predicted:
    """The judged frames of the first path for which a policy states a time, in ms, (n,)."""

    policy: PolicyResult
    predicted_ms: FloatArray
    simulated_ms: FloatArray

    @property
    def error_pct(self) -> FloatArray:
        return 100.0 * (self.predicted_ms / self.simulated_ms - 1.0)


def _predicted(results: Results, policy: PolicyResult) -> _Predicted | None:
    run = results.first_path(policy.label)
    stated = np.isfinite(prediction_error_pct(run))
    if not stated.any():
        return None
    return _Predicted(policy, run["predicted_gpu_ms"][stated], run["gpu_ms"][stated])


def _over_predicted(results: Results, known: list[_Predicted]) -> Plot:
    shown = [np.concatenate((each.simulated_ms, each.predicted_ms)) for each in known]
    low = min(float(np.quantile(ms, 0.005)) for ms in shown)
    high = max(float(np.quantile(ms, 0.995)) for ms in shown)
    low, high = 0.9 * max(low, 1e-3 * high), 1.1 * high
    x = Axis("predicted GPU time, ms", low, high, "log")
    y = Axis("simulated GPU time, ms", low, high, "log")
    ends = np.array([low, high])
    lines = [Line(Ink("", "", ""), line_of(Ink("", "", ""), (x, y), (ends, ends)).path, "rule")]
    lines += [line_of(results.inks[p.policy.label], (x, y), _medians(p)) for p in known]
    title = "Simulated over predicted GPU time"
    return Plot("simulated", title, x, y, lines, height_px=280)


def _medians(each: _Predicted) -> tuple[FloatArray, FloatArray]:
    """Return medians of both times in groups of frames of like predicted time.

    Groups by simulated time would show the noise of frames, which it holds, as a fault of the
    prediction: too little wherever frames happened to be slow.
    """
    order = np.argsort(each.predicted_ms, kind="stable")
    groups = [part for part in np.array_split(order, _PARTS) if len(part)]
    predicted, simulated = (
        np.array([float(np.median(ms[part])) for part in groups])
        for ms in (each.predicted_ms, each.simulated_ms)
    )
    return predicted, simulated


def _along_the_path(results: Results, known: list[_Predicted]) -> Plot:
    """Return the error of each frame's prediction, over the time of the path."""
    ends = [float(np.quantile(np.abs(each.error_pct), 0.99)) for each in known]
    end = min(max(1.2 * max(ends), _LEAST_PCT), _MOST_PCT)
    x, y = time_axis(results), Axis("error of prediction, %", -end, end)
    lines: list[Line] = []
    for label in (each.policy.label for each in known):
        run = MeasuredFrames(results.logs[label])
        points = envelope(run.time_s, prediction_error_pct(run), _BUCKETS)
        lines.append(line_of(results.inks[label], (x, y), points))
    rule = Rule(False, 50.0, "as predicted")
    title = "Predicted less simulated GPU time, % of simulated"
    return Plot("predicted", title, x, y, lines, rules=[rule], link=LINK)


def _table(results: Results, known: list[_Predicted]) -> Table:
    heads = (
        "policy",
        Cell("predicted ms", hint="Mean over the frames of the first path with a prediction"),
        Cell("simulated ms", hint="Mean over the same frames, as the simulator charged them"),
        Cell("predicted less simulated %", hint="Mean and standard deviation over these frames"),
        Cell(f"within {_NEAR_PCT:g} %", hint="Share of these frames"),
        Cell("error on all paths %", hint="Mean without sign, over all judged paths"),
    )
    return Table(heads, [tuple(_cells(results, each)) for each in known], name="predictions")


def _cells(results: Results, each: _Predicted) -> Iterator[Cell]:
    yield results.name_of(each.policy)
    for ms in (float(each.predicted_ms.mean()), float(each.simulated_ms.mean())):
        yield Cell(format_value(ms), value=ms)
    mean, sd = float(each.error_pct.mean()), float(each.error_pct.std())
    yield Cell(f"{'+' * (mean > 0.0)}{format_value(mean)} ± {format_value(sd)}", value=mean)
    near = float(np.mean(np.abs(each.error_pct) <= _NEAR_PCT))
    yield Cell(f"{100.0 * near:.0f} %", value=near)
    yield results.value_of(each.policy, MetricColumn(_ERROR, ""))


def _who_measured(results: Results) -> str:
    conditions, name = results.comparison.conditions, results.comparison.hardware
    basis = "assumed, not measured" if conditions.hardware_assumed else "measured or published"
    return (
        "Measured: nothing in this record; no machine drew these frames. What is simulated follows "
        f"the profile {name}, whose costs are {basis}. To hold simulated against measured frames, "
        "run lodbench validate; what came of it is in docs/validation.md."
    )
