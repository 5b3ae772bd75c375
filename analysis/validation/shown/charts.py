"""Charts of a validation: both series of every policy, and metric against metric."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ..metrics.measured_frames import MeasuredFrames
from ..report.series import envelope
from ..report.style import BUDGET, panels, styled
from .validate import Pair
from .validation_result import Validation
from .validation_table import RANKED

_BUCKETS = 500
_MEASURED, _AGAIN, _SIMULATED = "#D55E00", "#E69F00", "#0072B2"
_ROW_PX = 170


def series_chart(validation: Validation, pairs: Mapping[str, Pair]) -> Any:
    """Return frame times along the trace, measured and simulated, one row a policy."""
    labels = list(pairs)
    figure = panels(
        len(labels), 1, shared_xaxes=True, subplot_titles=labels,
        vertical_spacing=0.3 / (len(labels) + 1),
    )  # fmt: skip
    for row, pair in enumerate(pairs.values(), 1):
        drawn = [(f"measured{' again' * i}", m.frames) for i, m in enumerate(pair.measured)]
        drawn.append(("simulated", pair.simulated))
        for name, frames in drawn:
            run = MeasuredFrames(frames, *validation.window_s)
            x, y = envelope(run.time_s, run.work_ms, _BUCKETS)
            color = {"measured": _MEASURED, "simulated": _SIMULATED}.get(name, _AGAIN)
            figure.add_scatter(
                x=np.float32(x), y=np.float32(y), row=row, col=1, name=name, legendgroup=name,
                showlegend=row == 1, mode="lines", line={"color": color, "width": 1.1},
            )  # fmt: skip
        figure.add_hline(y=validation.budget_ms, row=row, col=1, line=BUDGET)
    figure.update_yaxes(rangemode="tozero", title_text="ms")
    figure.update_xaxes(title_text="time of the trace, s", row=len(labels), col=1)
    styled(figure, 90 + _ROW_PX * len(labels))
    figure.update_layout(margin={"t": 60})
    return figure


def agreement_chart(validation: Validation) -> Any:
    """Return simulated against measured values with their intervals, one panel a metric."""
    titles: list[str] = list(RANKED)
    figure = panels(1, len(titles), subplot_titles=titles)
    for column, name in enumerate(titles, 1):
        items = [(p.label, p.metrics[name]) for p in validation.policies]
        known = [(s, i) for s, i in items if i.measured is not None and i.simulated is not None]
        x = np.array([item.measured for _, item in known], dtype=np.float64)
        y = np.array([item.simulated for _, item in known], dtype=np.float64)
        low = np.array([y[k] if i.low is None else i.low for k, (_, i) in enumerate(known)])
        high = np.array([y[k] if i.high is None else i.high for k, (_, i) in enumerate(known)])
        figure.add_scatter(
            x=x, y=y, row=1, col=column, mode="markers", showlegend=False,
            text=[label for label, _ in known], hovertemplate="%{text}: %{x:.3g}, %{y:.3g}",
            marker={"color": _SIMULATED, "size": 8},
            error_y={"type": "data", "symmetric": False, "array": np.maximum(high - y, 0.0),
                     "arrayminus": np.maximum(y - low, 0.0), "thickness": 1, "width": 3},
        )  # fmt: skip
        end = 1.05 * float(max(x.max(initial=0.0), high.max(initial=0.0), 1e-9))
        figure.add_scatter(
            x=[0.0, end], y=[0.0, end], row=1, col=column, mode="lines", showlegend=False,
            hoverinfo="skip", line={"color": BUDGET["color"], "dash": "dash", "width": 1},
        )  # fmt: skip
        figure.update_xaxes(title_text="measured", range=(0.0, end), row=1, col=column)
        figure.update_yaxes(range=(0.0, end), row=1, col=column)
    figure.update_yaxes(title_text="simulated", row=1, col=1)
    return styled(figure, 360)
