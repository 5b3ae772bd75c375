"""How little the assumed price of a policy's own work decides on ``desktop-assumed``."""

import numpy as np
import pytest

import lodbench


@pytest.mark.slow
@pytest.mark.parametrize("policy", ["static-screen", "funkhouser", "zach"])
def test_tenfold_prices_change_the_work_of_no_frame(policy: str) -> None:
    """As `hardware.md` says of `district`: the GPU takes longer by more than any such price."""
    scene = lodbench.load_scene("district")
    trace = lodbench.load_trace("trial", scene).stretch(0.0, 3.0)
    hardware = lodbench.load_hardware("desktop-assumed")
    log = lodbench.replay(policy, scene, trace, hardware, budget_ms=16.7)
    cpu_ms, gpu_ms, select_ms = (np.asarray(log[n]) for n in ("cpu_ms", "gpu_ms", "select_ms"))
    assert select_ms.mean() > 0.0
    assert (gpu_ms - cpu_ms).min() > 0.8
    assert (gpu_ms > cpu_ms + 9.0 * select_ms).all()
