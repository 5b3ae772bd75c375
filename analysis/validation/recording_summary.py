"""What was recorded, in numbers."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from ...base.arrays import FloatArray
from ...render.gl.image_comparison import summarise_pictures
from .recordings import Recorded

IDENTIFIED = (
    "draw_calls",
    "triangles",
    "rasterized_triangles",
    "framebuffer_pixels",
    "bytes_uploaded",
    "state_changes",
)
"""Predictors whose costs a calibration is to tell apart, beside the base of a frame."""


def condition(columns: Mapping[str, FloatArray]) -> float:
    """Return the condition number of the design of a calibration, infinite if it is singular.

    The design has a column of ones and one of each of `IDENTIFIED`, divided by its mean.  An error
    of the times comes back in the costs times this number at most: 10 is good, and 100 leaves costs
    that cannot be told apart.
    """
    counts = np.column_stack([columns[name] for name in IDENTIFIED])
    mean = counts.mean(axis=0)
    design = np.column_stack((np.ones(len(counts)), counts / np.where(mean > 0.0, mean, 1.0)))
    return float(np.linalg.cond(design))


def summary_of(recorded: Recorded) -> dict[str, Any]:
    """Return what was recorded in numbers; medians of the repeats, in milliseconds."""
    columns, frame_ms = recorded.columns, recorded.columns["frame_ms"]
    means = {
        name: float(columns[name].mean())
        for name in ("draw_calls", "triangles", "shaded_samples", "cpu_ms", "policy_ms")
        if name in columns
    }
    record: dict[str, Any] = {
        "schema": "lodbench.record/1",
        "frames": len(recorded.frames),
        "frame_ms_mean": float(frame_ms.mean()),
        "frame_ms_sd": float(frame_ms.std(ddof=1)) if len(frame_ms) > 1 else 0.0,
        "frame_ms_p95": float(np.quantile(frame_ms, 0.95)),
        "means": means,
        "log": recorded.header,
    }
    if "frame_ms_low" in columns:
        spread = (columns["frame_ms_high"] - columns["frame_ms_low"]) / frame_ms
        record["repeats_spread_pct"] = 100.0 * float(np.median(spread))
    if "reference_before_ms" in columns:
        reference = columns["reference_before_ms"]
        record["reference_ms_mean"] = float(reference.mean())
        record["reference_ms_sd"] = float(reference.std())
    if "lag_ms" in columns:
        record["lag_ms_mean"] = float(columns["lag_ms"].mean())
    if "pass" in columns:
        record["condition"] = condition(columns)
    if recorded.pictures:
        record["pictures"] = summarise_pictures(recorded.pictures)
    return record
