"""Levels without triangles, counted by hand: missing, not drawn, and no call is made for them."""

from collections.abc import Callable

import numpy as np
import pytest

from lodbench.models.machine.hardware import HardwareProfile
from lodbench.models.scene.levels import LevelTable
from lodbench.policies.protocol import Policy
from lodbench.sim.frame_log import FrameLog

Run = Callable[..., FrameLog]
MakePolicy = Callable[..., Policy]
MakeLevels = Callable[..., LevelTable]
THREE = [(-1.0, 0.0, -10.0), (0.0, 0.0, -10.0), (1.0, 0.0, -10.0)]


@pytest.mark.parametrize("continuous", [False, True])
def test_a_level_of_nothing_is_missing(
    run: Run,
    scripted: MakePolicy,
    make_levels: MakeLevels,
    make_hardware: Callable[..., HardwareProfile],
    *,
    continuous: bool,
) -> None:
    """Of three objects none, one, then all are at the empty level: so many calls, so many holes."""
    levels = make_levels([(1000, 250, 0)], continuous=continuous)
    full, nothing = (1.0, 0.0) if continuous else (0.0, 2.0)
    details = [[full] * 3, [full, nothing, full], [nothing] * 3, [full] * 3]
    hardware = make_hardware({"draw_calls": 1.0}, base_ms=4.0)
    log = run(scripted(details), 4, positions=THREE, levels=levels, hardware=hardware)
    assert log["visible"].tolist() == [3] * 4
    assert log["drawn"].tolist() == [3, 2, 0, 3]
    assert log["missing"].tolist() == [0, 1, 3, 0]
    assert log["draw_calls"].tolist() == [3, 2, 0, 3]
    assert log["gpu_ms"].tolist() == [7, 6, 4, 7]
    # Full detail errs by nothing; of a hole of 2 m, 9 m ahead (or a little more, beside the axis),
    # 50 px high at 45 degrees, it is all.  Not drawn, it has the weight of what is drawn.
    beside_px = 50.0 * 2.0 / (np.hypot(10.0, 1.0) - 1.0)
    assert log["sse_px_max"] == pytest.approx([0.0, 100.0 / 9.0, 100.0 / 9.0, 0.0])
    assert log["sse_px_p95"] == pytest.approx([0.0, 0.0, beside_px, 0.0])
    assert (log["visible_error_area_px"] > 0.0).tolist() == [False, True, True, False]
    assert log["benefit"][2] == 0.0
    assert np.array_equal(log["full_benefit"], np.full(4, log["full_benefit"][0]))
