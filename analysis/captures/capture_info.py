"""What a capture holds: the record that `lodbench log info` prints."""

from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...traces.logs.log_checks import check_log
from ...traces.logs.render_log import TIMES, RenderLog
from ..metrics.metric_registry import find_metric
from .capture_frames import AVERAGE_FPS, bound_shares, busy_scores, intervals_of, score

SCHEMA = "lodbench.log-info/2"

_DIGITS = 6  # of every number; more would differ from machine to machine


@np.errstate(all="ignore")  # a frame of 1e308 ms overflows in sums, which the numbers then show
def capture_record(log: RenderLog) -> dict[str, Any]:
    """Return what a capture holds, as JSON: columns, metrics, findings.

    ``metrics`` has an entry for each id, with a value for each series of intervals.
    """
    intervals = intervals_of(log)
    findings = check_log(log)
    return _rounded(
        {
            "schema": SCHEMA,
            "log": log.name,
            "format": log.format,
            "frames": len(log),
            "duration_s": duration_s(log),
            "header": dict(log.header),
            "columns": [_column(log, name) for name in (*log.times, *log.predictors)],
            "unused": list(log.unused),
            "median_frame": median_words(log),
            "intervals": {name: len(values) for name, values in intervals.items()},
            "metrics": _metrics(intervals),
            "busy": busy_scores(log),
            "bound": bound_shares(log),
            **_presents(log),
            "findings": [
                {
                    "kind": finding.kind,
                    "column": finding.column,
                    "refuse": finding.refuse,
                    "message": finding.message,
                }
                for finding in findings
            ],
            "warnings": list(log.warnings),
            "notes": list(log.notes),
        }
    )


def duration_s(log: RenderLog) -> float | None:
    """Return how long a capture lasted, by its clock or else by its frames."""
    if log.time_s is not None and np.isfinite(log.time_s).sum() > 1:
        return float(np.nanmax(log.time_s) - np.nanmin(log.time_s))
    frames = intervals_of(log).get("frames")
    return None if frames is None else float(frames.sum()) / 1e3


def median_words(log: RenderLog) -> str:
    """Return how long the median frame takes, in words, since a wrong unit shows there first."""
    for name, what in (("frame_ms", "frame"), ("gpu_ms", "GPU's part"), ("cpu_ms", "CPU's part")):
        values = getattr(log, name)
        if values is not None and len(good := values[values > 0.0]):
            middle = float(np.median(good))
            rate = f", {1e3 / middle:.3g} a second" if name == "frame_ms" else ""
            return f"the median {what} takes {middle:.3g} ms{rate}"
    return "no frame has a time"


def _column(log: RenderLog, name: str) -> dict[str, Any]:
    values: FloatArray = log.time(name) if name in TIMES else log.columns([name])[:, 0]
    good = values[np.isfinite(values)]
    source = next((source for source in log.sources if source.name == name), None)
    return {
        "name": name,
        "source": name if source is None else source.source,
        "unit": "" if source is None else source.unit,
        "why": "" if source is None else source.why,
        "median": float(np.median(good)) if len(good) else None,
        "missing": len(values) - len(good),
    }


def _metrics(intervals: dict[str, FloatArray]) -> dict[str, Any]:
    scores = {name: score(values) for name, values in intervals.items()}
    ids = next(iter(scores.values())) if scores else ()
    return {
        metric: {
            "unit": "fps" if metric == AVERAGE_FPS else find_metric(metric).unit,
            **{name: values[metric] for name, values in scores.items()},
        }
        for metric in ids
    }


def _presents(log: RenderLog) -> dict[str, Any]:
    """Return what a tool that times presents knows beside: frames never shown, and made up."""
    timings = log.timings
    if timings is None:
        return {"dropped": None, "generated": None, "animation_error_ms_mean": None}
    error = np.abs(timings.animation_error_ms)
    error = error[np.isfinite(error)]
    return {
        "dropped": int(timings.dropped.sum()),
        "generated": timings.generated,
        "animation_error_ms_mean": float(error.mean()) if len(error) else None,
    }


def _rounded(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _rounded(item) for key, item in value.items()}  # pyright: ignore[reportUnknownVariableType]
    if isinstance(value, (list, tuple)):
        return [_rounded(item) for item in value]  # pyright: ignore[reportUnknownVariableType]
    return float(f"{value:.{_DIGITS}g}") if isinstance(value, float) else value
