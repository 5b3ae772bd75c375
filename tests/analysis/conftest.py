"""Frame logs built by hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lodbench.sim.frame_log import COUNTS, TIMES, FrameLog, LogHeader

MakeLog = Callable[..., FrameLog]


@pytest.fixture
def make_log() -> MakeLog:
    """Return a builder of frame logs: displays (ms, NaN if dropped), inputs, and any columns."""

    def build(
        display_ms: Any = None,
        *,
        input_ms: Any = None,
        budget_ms: float = 10.0,
        mode: str = "immediate",
        refresh_hz: float = 60.0,
        policy: str = "by-hand",
        memory_bound_bytes: float = 1e9,
        **columns: Any,
    ) -> FrameLog:
        given = display_ms if display_ms is not None else next(iter(columns.values()))
        n = len(np.atleast_1d(given))
        display = np.arange(n) * 10.0 + 10.0 if display_ms is None else np.asarray(display_ms)
        start = np.arange(n) * 10.0 if input_ms is None else np.asarray(input_ms)
        times = np.full((n, len(TIMES)), -1, dtype=np.int64)
        times[:, TIMES.index("input_ns")] = np.round(start * 1e6)
        shown = ~np.isnan(display)
        times[shown, TIMES.index("display_ns")] = np.round(display[shown] * 1e6)
        counts = np.zeros((n, len(COUNTS)))
        counts[:, COUNTS.index("predicted_gpu_ms")] = np.nan
        counts[:, COUNTS.index("benefit_bound")] = np.nan
        for name, values in columns.items():
            counts[:, COUNTS.index(name)] = values
        header = LogHeader(
            policy, "scene", "trace", "machine", budget_ms, 0, mode, refresh_hz, memory_bound_bytes
        )
        return FrameLog(header, times, counts)

    return build
