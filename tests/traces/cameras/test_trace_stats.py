"""Length, rate, speeds, turn rates, gaps and cuts of a trace."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lodbench.traces.cameras.camera_trace import CameraTrace, Repair
from lodbench.traces.cameras.trace_stats import trace_stats


def test_hand_worked_trace() -> None:
    """Steps of 1, 2, a cut of 100 and 4 m in a second each, then 2 m in ten seconds (a gap)."""
    times = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 14.0])
    x = np.array([0.0, 1.0, 3.0, 103.0, 107.0, 109.0])
    heading = Rotation.from_euler("z", [[0.0], [30.0], [60.0], [150.0], [160.0], [160.0]], True)
    trace = CameraTrace(
        "t",
        times,
        np.column_stack([x, 0 * x, 0 * x + 1.7]),
        heading.as_quat(),
        np.array([False, False, False, True, False, False]),
        repairs=(Repair(2, "repeated timestamps dropped"),),
    )
    stats = trace_stats(trace)
    assert (stats.samples, stats.duration_s, stats.rate_hz) == (6, 14.0, 1.0)
    assert stats.path_m == 1.0 + 2.0 + 4.0 + 2.0
    assert (stats.low_m, stats.high_m) == ((0.0, 0.0, 1.7), (109.0, 0.0, 1.7))
    # Speeds without the cut: 1, 2, 4 and 0.2 m/s; turn rates 30, 30, 10 and 0 degrees/s.
    assert (stats.speed_m_s.p50, stats.speed_m_s.max) == (1.5, 4.0)
    assert stats.turn_deg_s.p50 == pytest.approx(20.0)
    assert stats.turn_deg_s.max == pytest.approx(30.0)
    assert (stats.gaps, stats.longest_gap_s, stats.cuts) == (1, 10.0, 1)
    assert stats.repairs == ("2 repeated timestamps dropped",)


def test_one_sample_has_no_rates() -> None:
    """A still of no duration has zeros instead of divisions by zero."""
    trace = CameraTrace(
        "t", np.zeros(1), np.ones((1, 3)), np.array([[0.0, 0.0, 0.0, 1.0]]), np.zeros(1, bool)
    )
    stats = trace_stats(trace)
    assert (stats.rate_hz, stats.path_m, stats.speed_m_s.max, stats.gaps) == (0.0, 0.0, 0.0, 0)
